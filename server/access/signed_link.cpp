#include "server/access/signed_link.hpp"

#include <openssl/crypto.h>
#include <sys/stat.h>

#include <charconv>

#include "server/base/clock.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"

namespace unwrapd::server::access {
namespace {

constexpr std::size_t kSecretBytes = 32;
constexpr mode_t kOwnerOnly = 0600;

[[noreturn]] void refuse(const char* what) { throw Error(ErrorCode::invalid_link, what); }

std::string parameter(const http::Request& request, std::string_view name) {
  const auto found = request.query.find(std::string(name));
  return found == request.query.end() ? std::string() : found->second;
}

bool is_past(const std::string& expires) {
  std::int64_t seconds = 0;
  const char* end = expires.data() + expires.size();
  const auto parsed = std::from_chars(expires.data(), end, seconds);
  return parsed.ec != std::errc() || parsed.ptr != end || seconds < now_ms() / kMsPerSecond;
}

}  // namespace

std::string secret_in(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    const mode_t before = ::umask(~kOwnerOnly & 0777);
    write_file(file, random_hex(kSecretBytes));
    ::umask(before);
  }
  std::string secret = read_file(file);
  if (secret.size() == 2 * kSecretBytes) return secret;
  throw Error(ErrorCode::storage_failed,
              "The file " + file.string() +
                  " is damaged; remove it and the server makes a new one. Links and the secrets of "
                  "webhooks change with it.");
}

std::string LinkSigner::signature(const std::string& path, const std::string& expires,
                                  const LinkKey& key) const {
  const std::string of_key = key.id.empty() ? "" : "\n" + key.id + "\n" + key.sha256;
  return to_hex(hmac_sha256(secret_, "GET\n" + path + "\n" + expires + of_key));
}

std::string LinkSigner::sign(const std::string& path, std::int64_t expires,
                             const LinkKey& key) const {
  const std::string until = std::to_string(expires);
  std::string link = path + "?" + std::string(kExpiresParameter) + "=" + until;
  if (!key.id.empty()) link += "&" + std::string(kKeyParameter) + "=" + key.id;
  return link + "&" + std::string(kSignatureParameter) + "=" + signature(path, until, key);
}

std::string LinkSigner::key_of(const http::Request& request) {
  return parameter(request, kKeyParameter);
}

bool LinkSigner::is_signed(const http::Request& request) const {
  return request.query.contains(std::string(kSignatureParameter));
}

void LinkSigner::check(const http::Request& request, const LinkKey& key) const {
  const bool reads = request.method == "GET" || request.method == "HEAD";
  if (!reads) refuse("A signed link can only read; use an API key.");
  const std::string expires = parameter(request, kExpiresParameter);
  const std::string expected = signature(request.path, expires, key);
  const std::string given = parameter(request, kSignatureParameter);
  const bool same = given.size() == expected.size() &&
                    CRYPTO_memcmp(given.data(), expected.data(), given.size()) == 0;
  if (!same)
    refuse("The signature of the link does not match this server and address; ask for a new link.");
  if (is_past(expires)) refuse("The link has expired; ask for a new one.");
}

std::multimap<std::string, std::string> unsigned_query(const http::Request& request) {
  std::multimap<std::string, std::string> query = request.query;
  query.erase(std::string(kExpiresParameter));
  query.erase(std::string(kKeyParameter));
  query.erase(std::string(kSignatureParameter));
  return query;
}

}  // namespace unwrapd::server::access
