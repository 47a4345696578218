#include "server/http/cors.hpp"

#include <algorithm>

namespace unwrapd::server::http {
namespace {

constexpr const char* kMethods = "GET, HEAD, POST, PUT, DELETE";
constexpr const char* kRequestHeaders =
    "Authorization, Cache-Control, Content-Type, Idempotency-Key, If-None-Match, If-Range, "
    "Last-Event-ID, Prefer, Priority, Range, traceparent, Unwrapd-Webhook";
constexpr const char* kAnswerHeaders =
    "Content-Range, ETag, Location, Preference-Applied, Retry-After, Unwrapd-Report, "
    "traceparent, WWW-Authenticate";
constexpr const char* kKeptSeconds = "600";

}  // namespace

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
