#include "client/server_url.hpp"

#include <algorithm>

#include "client/failure.hpp"
#include "core/base/lower_case.hpp"
#include "core/base/parse_number.hpp"

namespace unwrapd::client {
namespace {

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw Failure(ExitCode::usage, "The server address \"" + std::string(text) + "\" " + why +
                                     "; write it as http://host:port.");
}

bool is_port(std::string_view digits) {
  const std::optional<int> port = parse_number<int>(digits);
  return port && *port > 0 && *port < 65536;
}

bool is_host_character(char c) {
  const bool alphanumeric =
      (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  return alphanumeric || c == '-' || c == '.' || c == '_';
}

/// Checks the host and returns what follows it: "" or ":port".
std::string_view after_host(std::string_view authority, std::string_view text) {
  if (authority.starts_with('[')) {
    const std::size_t bracket = authority.find(']');
    if (bracket == std::string_view::npos) refuse(text, "has no closing bracket");
    return authority.substr(bracket + 1);
  }
  const std::string_view host = authority.substr(0, authority.find(':'));
  if (host.empty()) refuse(text, "names no host");
  if (!std::ranges::all_of(host, is_host_character))
    refuse(text, "has a host that is not a valid name");
  return authority.substr(host.size());
}

void check_authority(std::string_view authority, std::string_view text) {
  const std::string_view port = after_host(authority, text);
  if (!port.empty() && !(port.front() == ':' && is_port(port.substr(1))))
    refuse(text, "has no valid port");
}

}  // namespace

ServerUrl parse_server_url(std::string_view text) {
  std::string scheme = "http";
  std::string_view rest = text;
  if (const std::size_t colon = text.find("://"); colon != std::string_view::npos) {
    scheme = lower_case(text.substr(0, colon));  // RFC 3986, 3.1
    rest = text.substr(colon + 3);
  }
  if (scheme != "http" && scheme != "https") refuse(text, "has a scheme that is not http or https");
  if (rest.find_first_of("?#@ ") != std::string_view::npos)
    refuse(text, "must not hold a user, a query or a fragment");
  const std::size_t slash = rest.find('/');
  const std::string_view authority = rest.substr(0, slash);
  check_authority(authority, text);
  std::string prefix(slash == std::string_view::npos ? std::string_view() : rest.substr(slash));
  while (prefix.ends_with('/')) prefix.pop_back();
  return {scheme + "://" + std::string(authority), std::move(prefix)};
}

std::vector<ServerUrl> parse_server_urls(std::string_view list) {
  std::vector<ServerUrl> all;
  while (true) {
    const std::size_t comma = list.find(',');
    all.push_back(parse_server_url(list.substr(0, comma)));
    if (comma == std::string_view::npos) return all;
    list.remove_prefix(comma + 1);
  }
}

}  // namespace unwrapd::client
