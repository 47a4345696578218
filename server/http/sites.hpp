#pragma once
// Which sites' pages may use the server from a browser, and which names the server answers to.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {

/// Which other sites' pages may call this server (CORS, as in the Fetch standard). None by default.
/// Credentials are not allowed: a page sets the header with its key itself.
class Cors {
 public:
  /// origins: "https://example.com", or "*" for every site.
  explicit Cors(std::vector<std::string> origins) : origins_(std::move(origins)) {}

  /// The answer to a preflight request of a site that is allowed; else std::nullopt.
  [[nodiscard]] std::optional<Response> preflight(const Request& request) const;
  /// Lets the page that sent the request read the answer, if its site is allowed.
  void allow(const Request& request, Response& response) const;
  [[nodiscard]] bool allows(const std::string& origin) const;

 private:
  const std::vector<std::string> origins_;
};

/// Whether one of the rules matches the host: "example.com" itself, "*.example.com" all hosts below
/// it, "*" every host.
bool is_named(std::string_view host, const std::vector<std::string>& rules);

/// Protects a server that asks for no API keys, where a browser on the same machine may do
/// everything. The page of any site can let its own name resolve to 127.0.0.1 a moment later (DNS
/// rebinding) and then has the same origin as the server. So a host must be an address,
/// `localhost`, or a name that the operator has given. Any page can also send a form, or a body
/// without a type, to another origin. So a request that changes something is refused if its Origin
/// is another one (ADR 0035). Where keys are asked for, neither helps a page: it has no key, and no
/// cookie replaces one.
class Sites {
 public:
  /// hosts: rules of is_named(). cors must outlive this.
  Sites(std::vector<std::string> hosts, const Cors& cors) : hosts_(std::move(hosts)), cors_(cors) {}

  /// The reason (`forbidden`) for which a request without a key is refused, if there is one.
  [[nodiscard]] std::optional<Error> refusal(const Request& request) const;

 private:
  const std::vector<std::string> hosts_;
  const Cors& cors_;
};

}  // namespace unwrapd::server::http
