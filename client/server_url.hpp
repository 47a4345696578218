#pragma once
// Where the server is.

#include <string>
#include <string_view>

namespace unwrapd::client {

/// origin: "http://host:port", as it stands in an Origin header; prefix: the path under which a
/// proxy publishes the service, "" or "/tools/unwrapd", never ending in a slash.
struct ServerUrl {
  std::string origin;
  std::string prefix;
};

/// Reads "http://host[:port][/prefix]", "https://…" or bare "host[:port]" (then http). IPv6
/// addresses stand in brackets. Throws Failure{usage}.
ServerUrl parse_server_url(std::string_view text);

}  // namespace unwrapd::client
