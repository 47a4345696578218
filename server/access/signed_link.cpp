#include "server/access/signed_link.hpp"

#include <openssl/crypto.h>
#include <sys/stat.h>

#include <optional>

#include "core/base/parse_number.hpp"
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

std::int64_t number_or_zero(const std::string& text) {
  return parse_number<std::int64_t>(text).value_or(0);
}

bool is_past(const std::string& expires) {
  return number_or_zero(expires) < now_ms() / kMsPerSecond;
}

/// What a link opens, as it is signed.
std::string opened_file(const std::string& path) { return "GET\n" + path; }

std::string opened_by_ticket(const std::string& id, const std::string& max_bytes) {
  return std::string("POST\n") + kTicketPath + "\n" + id + "\n" + max_bytes;
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

std::string LinkSigner::signature(const std::string& opened, const std::string& expires,
                                  const LinkKey& key) const {
  const std::string of_key = key.id.empty() ? "" : "\n" + key.id + "\n" + key.sha256;
  return to_hex(hmac_sha256(secret_, opened + "\n" + expires + of_key));
}

std::string LinkSigner::signed_query(const std::string& opened, std::int64_t expires,
                                     const LinkKey& key) const {
  const std::string until = std::to_string(expires);
  std::string query = std::string(kExpiresParameter) + "=" + until;
  if (!key.id.empty()) query += "&" + std::string(kKeyParameter) + "=" + key.id;
  return query + "&" + std::string(kSignatureParameter) + "=" + signature(opened, until, key);
}

std::string LinkSigner::sign(const std::string& path, std::int64_t expires,
                             const LinkKey& key) const {
  return path + "?" + signed_query(opened_file(path), expires, key);
}

std::string LinkSigner::sign(const http::Ticket& ticket, const LinkKey& key) const {
  const std::string max_bytes = std::to_string(ticket.max_bytes);
  return std::string(kTicketPath) + "?" + std::string(kTicketParameter) + "=" + ticket.id + "&" +
         std::string(kMaxBytesParameter) + "=" + max_bytes + "&" +
         signed_query(opened_by_ticket(ticket.id, max_bytes), ticket.expires, key);
}

std::string LinkSigner::key_of(const http::Request& request) {
  return parameter(request, kKeyParameter);
}

bool LinkSigner::is_signed(const http::Request& request) {
  return request.query.contains(std::string(kSignatureParameter));
}

bool LinkSigner::is_ticket(const http::Request& request) {
  return request.query.contains(std::string(kTicketParameter));
}

void LinkSigner::check_signature(const http::Request& request, const std::string& opened,
                                 const LinkKey& key) const {
  const std::string expires = parameter(request, kExpiresParameter);
  const std::string expected = signature(opened, expires, key);
  const std::string given = parameter(request, kSignatureParameter);
  const bool same = given.size() == expected.size() &&
                    CRYPTO_memcmp(given.data(), expected.data(), given.size()) == 0;
  if (!same)
    refuse("The signature of the link does not match this server and address; ask for a new link.");
  if (is_past(expires)) refuse("The link has expired; ask for a new one.");
}

void LinkSigner::check(const http::Request& request, const LinkKey& key) const {
  const bool reads = request.method == "GET" || request.method == "HEAD";
  if (!reads) refuse("A signed link can only read; use an API key.");
  check_signature(request, opened_file(request.path), key);
}

http::Ticket LinkSigner::check_ticket(const http::Request& request, const LinkKey& key) const {
  if (request.method != "POST" || request.path != kTicketPath)
    refuse("An upload ticket opens POST /v1/jobs alone; use an API key.");
  const std::string id = parameter(request, kTicketParameter);
  const std::string max_bytes = parameter(request, kMaxBytesParameter);
  check_signature(request, opened_by_ticket(id, max_bytes), key);
  return {.id = id,
          .max_bytes = number_or_zero(max_bytes),
          .expires = number_or_zero(parameter(request, kExpiresParameter))};
}

std::multimap<std::string, std::string> unsigned_query(const http::Request& request) {
  std::multimap<std::string, std::string> query = request.query;
  query.erase(std::string(kExpiresParameter));
  query.erase(std::string(kKeyParameter));
  query.erase(std::string(kSignatureParameter));
  if (!LinkSigner::is_ticket(request)) return query;
  query.erase(std::string(kTicketParameter));
  query.erase(std::string(kMaxBytesParameter));
  return query;
}

}  // namespace unwrapd::server::access
