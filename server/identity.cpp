#include "server/identity.hpp"

#include <openssl/evp.h>
#include <openssl/rand.h>

#include <array>
#include <span>

#include "core/error.hpp"

namespace unwrapd::server {
namespace {

constexpr std::string_view kHexDigits = "0123456789abcdef";
constexpr std::string_view kIdPrefix = "j_";
constexpr std::size_t kIdBytes = 16;

std::string hex(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kHexDigits[byte >> 4];
    text += kHexDigits[byte & 15];
  }
  return text;
}

void check(int result) {
  if (result != 1) throw Error(ErrorCode::internal, "The cryptographic library failed; try again.");
}

}  // namespace

std::string random_job_id() {
  std::array<unsigned char, kIdBytes> bytes{};
  check(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())));
  return std::string(kIdPrefix) + hex(bytes);
}

bool is_job_id(std::string_view text) {
  if (text.size() != kIdPrefix.size() + 2 * kIdBytes || !text.starts_with(kIdPrefix)) return false;
  return text.find_first_not_of(kHexDigits, kIdPrefix.size()) == std::string_view::npos;
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

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.finish();
}

}  // namespace unwrapd::server
