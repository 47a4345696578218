#include "server/base/identity.hpp"

#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <array>
#include <span>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::server {
namespace {

constexpr std::string_view kHexDigits = "0123456789abcdef";
constexpr std::string_view kIdPrefix = "j_";
constexpr std::string_view kMeshPrefix = "m_";
constexpr std::size_t kSha256Digits = 64;
constexpr std::size_t kIdBytes = 16;

std::string hex(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kHexDigits[byte >> 4];
    text += kHexDigits[byte & 15];
  }
  return text;
}

bool is_id(std::string_view text, std::string_view prefix) {
  return text.size() == prefix.size() + 2 * kIdBytes && text.starts_with(prefix) &&
         text.find_first_not_of(kHexDigits, prefix.size()) == std::string_view::npos;
}

void check(int result) {
  if (result != 1) throw Error(ErrorCode::internal, "The cryptographic library failed; try again.");
}

}  // namespace

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  check(RAND_bytes(random.data(), static_cast<int>(random.size())));
  return hex(random);
}

std::string random_job_id() { return std::string(kIdPrefix) + random_hex(kIdBytes); }

bool is_job_id(std::string_view text) { return is_id(text, kIdPrefix); }

std::string random_mesh_id() { return std::string(kMeshPrefix) + random_hex(kIdBytes); }

bool is_mesh_id(std::string_view text) { return is_id(text, kMeshPrefix); }

bool is_sha256(std::string_view text) {
  return text.size() == kSha256Digits && text.find_first_not_of(kHexDigits) == std::string::npos;
}

void Sha256::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  check(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

void Sha256::add(std::string_view bytes) {
  check(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
}

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  check(EVP_DigestFinal_ex(context_.get(), digest.data(), &size));
  return hex(std::span(digest).first(size));
}

std::string hmac_sha256(std::string_view secret, std::string_view message) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  const auto* text = reinterpret_cast<const unsigned char*>(message.data());
  const unsigned char* done = HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
                                   text, message.size(), digest.data(), &size);
  check(done != nullptr ? 1 : 0);
  return {digest.begin(), digest.begin() + size};
}

std::string to_hex(std::string_view bytes) {
  return hex(std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.finish();
}

}  // namespace unwrapd::server
