#include "server/http/sites.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/lower_case.hpp"

namespace unwrapd::server::http {
namespace {

constexpr auto kSafe = std::to_array<std::string_view>({"GET", "HEAD", "OPTIONS"});

/// "[::1]:80" without its port.
std::string_view host_name(std::string_view host) {
  const std::size_t bracket = std::min(host.find(']'), host.size());
  const std::size_t colon = host.starts_with('[') ? host.find(':', bracket) : host.find(':');
  return host.substr(0, colon);
}

/// Whether the host is an address in a notation that all browsers send: no name can be one.
bool is_numeric_host(const std::string& host) {
  std::array<std::uint8_t, 16> bytes{};
  if (!host.starts_with('[')) return inet_pton(AF_INET, host.c_str(), bytes.data()) == 1;
  const std::string within = host.substr(1, host.size() - 2);
  return host.ends_with(']') && inet_pton(AF_INET6, within.c_str(), bytes.data()) == 1;
}

/// "https://example.com:8080" -> "example.com:8080"; a proxy may add or end TLS.
std::string_view host_of_origin(std::string_view origin) {
  const std::size_t scheme = origin.find("://");
  return scheme == std::string_view::npos ? std::string_view() : origin.substr(scheme + 3);
}

constexpr const char* kMethods = "GET, HEAD, POST, PUT, DELETE";
constexpr const char* kRequestHeaders =
    "Authorization, Cache-Control, Content-Type, Idempotency-Key, If-None-Match, If-Range, "
    "Last-Event-ID, Prefer, Priority, Range, traceparent, Unwrapd-Webhook";
constexpr const char* kAnswerHeaders =
    "Content-Range, ETag, Location, Preference-Applied, Retry-After, Unwrapd-Report, "
    "traceparent, WWW-Authenticate";
constexpr const char* kKeptSeconds = "600";

}  // namespace

bool is_named(std::string_view host, const std::vector<std::string>& rules) {
  return std::ranges::any_of(rules, [&](std::string_view rule) {
    if (rule == "*") return true;
    if (!rule.starts_with("*.")) return rule == host;
    return host.size() > rule.size() - 1 && host.ends_with(rule.substr(1));
  });
}

std::optional<Error> Sites::refusal(const Request& request) const {
  const std::string host = lower_case(request.host);  // names have no case; rules are in lower case
  const std::string name(host_name(host));
  const bool known = host.empty() || name == "localhost" || is_numeric_host(name) ||
                     is_named(name, hosts_);  // HTTP/1.0, which no browser speaks, needs none
  if (!known) {
    return Error(ErrorCode::forbidden,
                 "This server runs without API keys, so it answers only to addresses, localhost "
                 "and the names of --allowed-hosts; ask its operator to add this name.");
  }
  const std::string origin = lower_case(request.header("Origin"));
  const bool safe = std::ranges::count(kSafe, request.method) > 0;
  if (safe || origin.empty() || host_of_origin(origin) == host || cors_.allows(origin))
    return std::nullopt;
  return Error(ErrorCode::forbidden,
               "This server runs without API keys, so pages of other sites may not change "
               "anything; its operator can allow a site by --cors-origins.");
}

bool Cors::allows(const std::string& origin) const {
  if (origin.empty()) return false;
  return std::ranges::any_of(
      origins_, [&](const std::string& allowed) { return allowed == "*" || allowed == origin; });
}

std::optional<Response> Cors::preflight(const Request& request) const {
  const bool asks =
      request.method == "OPTIONS" && !request.header("Access-Control-Request-Method").empty();
  if (!asks || !allows(request.header("Origin"))) return std::nullopt;
  Response response;
  response.status = 204;
  response.headers = {{"Access-Control-Allow-Methods", kMethods},
                      {"Access-Control-Allow-Headers", kRequestHeaders},
                      {"Access-Control-Max-Age", kKeptSeconds}};
  return response;
}

void Cors::allow(const Request& request, Response& response) const {
  if (origins_.empty()) return;
  response.headers.emplace_back("Vary", "Origin");
  const std::string origin = request.header("Origin");
  if (!allows(origin)) return;
  response.headers.emplace_back("Access-Control-Allow-Origin", origin);
  response.headers.emplace_back("Access-Control-Expose-Headers", kAnswerHeaders);
}

}  // namespace unwrapd::server::http
