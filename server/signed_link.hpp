#pragma once
// Links that open one file of one job without an API key, until they expire: for a browser, or for
// whoever a result is passed on to. A link ends in ?expires=SECONDS&signature=HEX, the HMAC-SHA256
// of its path and that time under a secret of this server. Other parameters, which choose among the
// forms of that file, stay free.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "server/http.hpp"

namespace unwrapd::server {

inline constexpr const char* kSecretFile = "secret";  // in the data directory
inline constexpr std::string_view kExpiresParameter = "expires";
inline constexpr std::string_view kSignatureParameter = "signature";

/// The secret in a file, readable by its owner alone; made of 256 random bits when it is missing.
std::string secret_in(const std::filesystem::path& file);

class LinkSigner {
 public:
  explicit LinkSigner(std::string secret) : secret_(std::move(secret)) {}

  /// The path with the parameters that open it until then (seconds since 1970).
  [[nodiscard]] std::string sign(const std::string& path, std::int64_t expires) const;
  [[nodiscard]] bool is_signed(const Request& request) const;
  /// Throws Error{invalid_link} unless the link is for this, of this server and not expired.
  void check(const Request& request) const;

 private:
  [[nodiscard]] std::string signature(const std::string& path, const std::string& expires) const;

  const std::string secret_;
};

/// The query of a request without what signs it.
std::multimap<std::string, std::string> unsigned_query(const Request& request);

}  // namespace unwrapd::server
