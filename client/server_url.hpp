#pragma once
// The address of the server.

#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::client {

/// origin: "http://host:port", as in an Origin header; prefix: the path under which a proxy
/// publishes the service, "" or "/tools/unwrapd", without a slash at its end; key: the API key to
/// send, empty: none.
struct ServerUrl {
  std::string origin;
  std::string prefix;
  std::string key = {};
};

/// Reads "http://host[:port][/prefix]", "https://…" or bare "host[:port]" (then http). IPv6
/// addresses need brackets. Throws Failure{usage}.
ServerUrl parse_server_url(std::string_view text);

/// The same of a list with commas.
std::vector<ServerUrl> parse_server_urls(std::string_view list);

}  // namespace unwrapd::client
