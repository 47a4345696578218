#include "server/http/router.hpp"

#include <exception>
#include <optional>

#include "api/error_table.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"

namespace unwrapd::server::http {
namespace {

constexpr std::string_view kIdSegment = "{id}";
constexpr std::string_view kDigestSegment = "{sha256}";
constexpr std::string_view kNameSegment = "{name}";

/// Removes and returns the first segment of a path.
std::string_view take_segment(std::string_view& path) {
  const std::size_t end = path.find('/', 1);
  const std::string_view segment = path.substr(0, end);
  path.remove_prefix(segment.size());
  return segment.substr(1);
}

/// The values of the variable segments of a path.
struct PathNames {
  std::string id;
  std::string sha256;
};

/// Empty when the path is not of this route.
std::optional<PathNames> match(std::string_view route, std::string_view path) {
  PathNames names;
  while (!route.empty() && !path.empty()) {
    const std::string_view expected = take_segment(route);
    const std::string_view segment = take_segment(path);
    if (expected == kIdSegment && is_job_id(segment)) {
      names.id = segment;
    } else if (expected == kDigestSegment && is_sha256(segment)) {
      names.sha256 = segment;
    } else if (expected != segment && (expected != kNameSegment || segment.empty())) {
      return std::nullopt;
    }
  }
  if (!route.empty() || !path.empty()) return std::nullopt;
  return names;
}

/// Whether the operator should see an error. An exhausted quota concerns only the owner of the key.
bool is_ours(ErrorCode code) {
  return api::error_row(code).status >= 500 && code != ErrorCode::quota_exceeded;
}

/// The answer to OPTIONS, and to methods that are not allowed.
Response tell_allowed(const Request& request, const std::string& allowed) {
  Response response;
  response.status = 204;
  if (request.method != "OPTIONS")
    response =
        error_response(Error(ErrorCode::method_not_allowed,
                             "This method is not allowed here; use one of " + allowed + "."));
  response.headers.emplace_back("Allow", allowed);
  return response;
}

}  // namespace

Response Router::answer(Request request) const noexcept {
  std::string_view route;
  Response response = guarded(request, route);
  response.route = route;
  return response;
}

Response Router::guarded(Request& request, std::string_view& route) const noexcept {
  try {
    return dispatch(request, route);
  } catch (const Error& error) {
    if (is_ours(error.code()))
      log_.error("request failed", {{"job", request.id}, {"reason", reason_of(error)}});
    return error_response(error, request.id);
  } catch (const std::exception& error) {  // the caller learns nothing of our insides
    log_.error("unhandled exception", {{"job", request.id}, {"reason", reason_of(error)}});
    return error_response(Error(ErrorCode::internal, "The server failed to answer; try again."));
  }
}

Response Router::dispatch(Request& request, std::string_view& matched) const {
  const std::string_view method =
      request.method == "HEAD" ? "GET" : std::string_view(request.method);
  std::string allowed;
  for (const Route& route : routes_) {
    const std::optional<PathNames> names = match(route.path, request.path);
    if (!names) continue;
    matched = route.path;
    if (route.method == method) {
      request.id = names->id;
      request.sha256 = names->sha256;
      if (request.refusal) throw Error(*request.refusal);
      if (admit_) admit_(request, route.path);
      return route.handler(request);
    }
    allowed += (allowed.empty() ? "" : ", ") + std::string(route.method);
    if (route.method == "GET") allowed += ", HEAD";
  }
  if (!allowed.empty()) return tell_allowed(request, allowed + ", OPTIONS");
  throw Error(ErrorCode::not_found, "There is nothing at this address; see /openapi.yaml.");
}

}  // namespace unwrapd::server::http
