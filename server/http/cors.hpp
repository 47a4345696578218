#pragma once
// Which other sites' pages may call this server from a browser (CORS, as the Fetch standard has
// it). None by default. No credentials are allowed: a key travels in a header that the page sets
// itself.

#include <optional>
#include <string>
#include <vector>

#include "server/http/http.hpp"

namespace unwrapd::server::http {

class Cors {
 public:
  /// origins: "https://example.com", or "*" for every site.
  explicit Cors(std::vector<std::string> origins) : origins_(std::move(origins)) {}

  /// The answer to a browser that asks beforehand; nothing for any other request, or another site.
  [[nodiscard]] std::optional<Response> preflight(const Request& request) const;
  /// Lets the page that asked read the answer, if its site may.
  void allow(const Request& request, Response& response) const;
  [[nodiscard]] bool allows(const std::string& origin) const;

 private:
  const std::vector<std::string> origins_;
};

}  // namespace unwrapd::server::http
