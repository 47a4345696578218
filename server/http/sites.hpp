#pragma once
// Which names a server answers to, and whose pages may change something on it, where no API keys
// are asked for: there, a browser on the same machine is all the right that a request needs. A page
// of any site can have its own name resolve to 127.0.0.1 a moment later (DNS rebinding) and is then
// of the same origin as the server: so a host is an address, `localhost`, or what the operator
// names. And any page can send a form, or a body without a type, to another origin: so what changes
// something is refused when its Origin is another one (ADR 0035).
//
// Where keys are asked for, neither helps a page: it has no key, and no cookie stands for one.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "server/http/cors.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {

/// Whether a rule of a list of hosts names this host: "example.com" itself, "*.example.com" each
/// below it, "*" any.
bool is_named(std::string_view host, const std::vector<std::string>& rules);

class Sites {
 public:
  /// hosts: is_named() rules; cors: whose pages may call, which outlives this.
  Sites(std::vector<std::string> hosts, const Cors& cors) : hosts_(std::move(hosts)), cors_(cors) {}

  /// Why a request without a key is not answered (`forbidden`), if so.
  [[nodiscard]] std::optional<Error> refusal(const Request& request) const;

 private:
  const std::vector<std::string> hosts_;
  const Cors& cors_;
};

}  // namespace unwrapd::server::http
