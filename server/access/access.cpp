#include "server/access/access.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "core/figure/image.hpp"
#include "server/http/addresses.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::access {
namespace {

constexpr std::string_view kScheme = "Bearer ";
constexpr double kMegapixel = 1024.0 * 1024.0;
// Open to everybody: what the server is and whether it is well, and no job.
constexpr auto kPublic = std::to_array<std::string_view>(
    {"/", "/assets/{name}", "/docs", "/openapi.yaml", "/openapi.json", "/v1/methods", "/v1/limits",
     "/healthz", "/readyz"});

/// Schemes have no case (RFC 9110, 11.1).
bool is_bearer(std::string_view field) {
  const std::string_view scheme = field.substr(0, kScheme.size());
  return http::same_word(scheme, kScheme);
}

bool is_public(std::string_view route) { return std::ranges::count(kPublic, route) > 0; }

bool only_reads(const http::Request& request) {
  return request.method == "GET" || request.method == "HEAD";
}

bool allows(const Scopes& scopes, const http::Request& request) {
  return scopes.admin || (only_reads(request) ? scopes.read : scopes.submit);
}

http::Caller caller_with(const ApiKey& key) {
  return {
      .owner = key.id, .sees_all = key.scopes.admin, .quota = key.quota, .key_sha256 = key.sha256};
}

}  // namespace

bool asks_for_keys(const AccessConfig& config, std::string_view host) {
  const bool wanted = config.require_keys || !config.key_file.empty();
  const bool is_here = host == "localhost" || http::is_loopback(host);  // no name that begins so
  return wanted || (!is_here && !config.insecure);
}

double cost_of(const http::Request& request, std::string_view route) {
  const auto size = request.query.find("size");
  if (!route.ends_with(".png") || size == request.query.end()) return 1;
  const std::string& text = size->second;
  int pixels = text == "page" ? figure::kMaxImageSize : 0;  // what is no size is refused
  std::from_chars(text.data(), text.data() + text.size(), pixels);
  pixels = std::clamp(pixels, 0, figure::kMaxImageSize);
  return std::max(1.0, pixels * static_cast<double>(pixels) / kMegapixel);
}

ApiKey Access::key_of(const http::Request& request) {
  const std::string field = request.header("Authorization");
  std::optional<ApiKey> key;
  if (is_bearer(field)) key = keys_.find(std::string_view(field).substr(kScheme.size()));
  if (key) return std::move(*key);
  throw Error(ErrorCode::unauthorized,
              "This server requires an API key; send it as Authorization: Bearer KEY.");
}

void Access::admit(http::Request& request, std::string_view route) {
  if (is_public(route)) return;
  const double cost = cost_of(request, route);
  if (links_.is_signed(request)) return open_link(request, cost);
  request.caller = caller_of(request, cost);
}

/// A request by a signed link or a ticket acts for the key of that link.
void Access::open_link(http::Request& request, double cost) {
  const std::string id = LinkSigner::key_of(request);
  const std::optional<ApiKey> key = id.empty() ? std::nullopt : keys_.with_id(id);
  if (!key && (ask_ || !id.empty()))
    throw Error(
        ErrorCode::invalid_link,
        "The link was made without an API key, or with one that was removed; ask for a new link.");
  const LinkKey made_with = key ? LinkKey{.id = id, .sha256 = key->sha256} : LinkKey();
  http::Caller caller = key ? caller_with(*key) : http::Caller();
  if (LinkSigner::is_ticket(request)) {
    request.ticket = links_.check_ticket(request, made_with);
  } else {
    links_.check(request, made_with);
    caller.sees_all = true;  // what is signed is the path of one job
  }
  if (key) spend(*key, cost);
  request.query = unsigned_query(request);
  request.caller = std::move(caller);
}

void Access::spend(const ApiKey& key, double cost) {
  const int wait = keys_.wait_seconds(key, cost);
  if (wait == 0) return;
  throw RetryLater(
      ErrorCode::rate_limited,
      "This API key may be used " + std::to_string(key.requests_per_minute) +
          " times a minute (a large picture counts several times); continue after Retry-After.",
      wait);
}

http::Caller Access::caller_of(const http::Request& request, double cost) {
  if (!ask_) return {};
  const ApiKey key = key_of(request);
  spend(key, cost);
  if (!allows(key.scopes, request)) {
    throw Error(ErrorCode::forbidden, "This API key lacks the scope " +
                                          std::string(only_reads(request) ? "read" : "submit") +
                                          "; use another one.");
  }
  return caller_with(key);
}

}  // namespace unwrapd::server::access
