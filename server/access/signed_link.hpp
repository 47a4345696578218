#pragma once
// Links that open one resource of one job without an API key, until they expire: for a browser, or
// to pass a result on. A link ends in ?expires=SECONDS&key=ID&signature=HEX. The signature is the
// HMAC-SHA256 of its method, path, that time and the digest of the API key that it was made with,
// under a secret of this server, so that the link ends with the key. Where no keys are required,
// there is no `key`. Other parameters, which choose among the forms of the file, remain free.
//
// An upload ticket is such a link to POST /v1/jobs. It also names itself and the size of what may
// be sent, ?ticket=ID&max_bytes=N, which are signed with it.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "server/http/http.hpp"

namespace unwrapd::server::access {

inline constexpr const char* kSecretFile = "secret";  // in the data directory
inline constexpr std::string_view kExpiresParameter = "expires";
inline constexpr std::string_view kKeyParameter = "key";
inline constexpr std::string_view kSignatureParameter = "signature";
inline constexpr std::string_view kTicketParameter = "ticket";
inline constexpr std::string_view kMaxBytesParameter = "max_bytes";
inline constexpr const char* kTicketPath = "/v1/jobs";  // that a ticket opens, to POST

/// The secret in a file, readable by its owner alone; made of 256 random bits when it is missing.
std::string secret_in(const std::filesystem::path& file);

/// The API key that a link is made with; empty where there is none.
struct LinkKey {
  std::string id;
  std::string sha256;
};

class LinkSigner {
 public:
  explicit LinkSigner(std::string secret) : secret_(std::move(secret)) {}

  /// The path with the parameters that open it until then (seconds since 1970).
  [[nodiscard]] std::string sign(const std::string& path, std::int64_t expires,
                                 const LinkKey& key = {}) const;
  /// The same of the path to which the bearer of a ticket sends a job.
  [[nodiscard]] std::string sign(const http::Ticket& ticket, const LinkKey& key = {}) const;
  [[nodiscard]] static bool is_signed(const http::Request& request);
  [[nodiscard]] static bool is_ticket(const http::Request& request);
  /// The id of the key that a link says it was made with; empty when it names none.
  [[nodiscard]] static std::string key_of(const http::Request& request);
  /// Throws Error{invalid_link} unless the link is for this, of this server, made with this key and
  /// not expired.
  void check(const http::Request& request, const LinkKey& key) const;
  /// The ticket of a request. Throws like check(). Whether it was used is for others to say.
  [[nodiscard]] http::Ticket check_ticket(const http::Request& request, const LinkKey& key) const;

 private:
  [[nodiscard]] std::string signed_query(const std::string& opened, std::int64_t expires,
                                         const LinkKey& key) const;
  void check_signature(const http::Request& request, const std::string& opened,
                       const LinkKey& key) const;
  [[nodiscard]] std::string signature(const std::string& opened, const std::string& expires,
                                      const LinkKey& key) const;

  const std::string secret_;
};

/// The query of a request without what signs it.
std::multimap<std::string, std::string> unsigned_query(const http::Request& request);

}  // namespace unwrapd::server::access
