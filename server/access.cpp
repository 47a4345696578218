#include "server/access.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/addresses.hpp"
#include "server/job_queue.hpp"

namespace unwrapd::server {
namespace {

constexpr std::string_view kScheme = "Bearer ";
constexpr double kSecondsPerMinute = 60;
// Open to everybody: what the server is and whether it is well, and no job.
constexpr auto kPublic = std::to_array<std::string_view>(
    {"/", "/page.css", "/page.js", "/docs", "/docs.css", "/openapi.yaml", "/openapi.json",
     "/v1/methods", "/v1/limits", "/healthz", "/readyz"});

/// Schemes have no case (RFC 9110, 11.1).
bool is_bearer(std::string_view field) {
  const std::string_view scheme = field.substr(0, kScheme.size());
  return !IgnoreCase()(scheme, kScheme) && !IgnoreCase()(kScheme, scheme);
}

bool is_public(std::string_view route) { return std::ranges::count(kPublic, route) > 0; }

bool only_reads(const Request& request) {
  return request.method == "GET" || request.method == "HEAD";
}

bool allows(const Scopes& scopes, const Request& request) {
  return scopes.admin || (only_reads(request) ? scopes.read : scopes.submit);
}

}  // namespace

bool asks_for_keys(const AccessConfig& config, std::string_view host) {
  const bool wanted = config.require_keys || !config.key_file.empty();
  const bool is_here = host == "localhost" || is_loopback(host);  // no name that begins so
  return wanted || (!is_here && !config.insecure);
}

int RateLimit::wait_seconds(const std::string& key, std::int64_t per_minute,
                            Clock::time_point now) {
  if (per_minute == 0) return 0;
  const auto most = static_cast<double>(per_minute);
  const std::lock_guard lock(mutex_);
  const auto [found, is_new] = buckets_.try_emplace(key, Bucket{.tokens = most, .filled = now});
  Bucket& bucket = found->second;
  const std::chrono::duration<double> since = now - bucket.filled;
  bucket.tokens = std::min(most, bucket.tokens + since.count() * most / kSecondsPerMinute);
  bucket.filled = now;
  if (bucket.tokens >= 1) {
    bucket.tokens -= 1;
    return 0;
  }
  return static_cast<int>(std::ceil((1 - bucket.tokens) * kSecondsPerMinute / most));
}

ApiKey Access::key_of(const Request& request) {
  const std::string field = request.header("Authorization");
  std::optional<ApiKey> key;
  if (is_bearer(field)) key = keys_.find(std::string_view(field).substr(kScheme.size()));
  if (key) return std::move(*key);
  throw Error(ErrorCode::unauthorized,
              "This server asks for an API key; send it as Authorization: Bearer KEY.");
}

void Access::admit(Request& request, std::string_view route) {
  if (is_public(route)) return;
  if (!links_.is_signed(request)) {
    request.caller = caller_of(request);
    return;
  }
  links_.check(request);
  request.query = unsigned_query(request);
}

Caller Access::caller_of(const Request& request) {
  if (!ask_) return {};
  const ApiKey key = key_of(request);
  const int wait =
      rates_.wait_seconds(key.id, key.requests_per_minute, std::chrono::steady_clock::now());
  if (wait > 0) {
    throw RetryLater(ErrorCode::rate_limited,
                     "This API key may be used " + std::to_string(key.requests_per_minute) +
                         " times a minute; go on after Retry-After.",
                     wait);
  }
  if (!allows(key.scopes, request)) {
    throw Error(ErrorCode::forbidden, "This API key lacks the scope " +
                                          std::string(only_reads(request) ? "read" : "submit") +
                                          "; use another one.");
  }
  return {.owner = key.id, .sees_all = key.scopes.admin, .quota = key.quota};
}

}  // namespace unwrapd::server
