#include "client/http_redirect.hpp"

#include <algorithm>
#include <array>

#include "client/failure.hpp"

namespace unwrapd::client {
namespace {

constexpr std::array kRedirects = {301, 302, 303, 307, 308};
constexpr std::string_view kAfterScheme = "://";

/// Where the path of a URL begins.
std::size_t path_begin(std::string_view url) {
  const std::size_t host = url.find(kAfterScheme) + kAfterScheme.size();
  return std::min(url.find_first_of("/?", host), url.size());
}

}  // namespace

bool is_redirect(int status) { return std::ranges::count(kRedirects, status) > 0; }

Destination redirected(const ServerUrl& from, std::string_view location) {
  std::string url(location.substr(0, location.find('#')));
  if (url.starts_with("//"))
    url = from.origin.substr(0, from.origin.find("//")) + url;
  else if (url.starts_with('/'))
    url = from.origin + url;
  const std::size_t path = path_begin(url);
  try {
    if (url.find(kAfterScheme) >= path) throw Failure(ExitCode::usage, "no scheme");
    Destination to{.server = parse_server_url(url.substr(0, path)), .path = url.substr(path)};
    if (!to.path.starts_with('/')) to.path.insert(0, "/");
    if (to.server.origin == from.origin) to.server.key = from.key;
    return to;
  } catch (const Failure&) {
    throw Failure(
        ExitCode::unreachable,
        "The server at " + from.origin + " redirects to what is no address; check the address.");
  }
}

}  // namespace unwrapd::client
