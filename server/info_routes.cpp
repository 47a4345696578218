#include "server/info_routes.hpp"

#include "api/openapi.hpp"
#include "api/options.hpp"

namespace unwrapd::server {
namespace {

constexpr std::string_view kOk = R"({"status":"ok"})";

Response contract() {
  Response response;
  response.content_type = "application/yaml";
  response.body = std::string(api::openapi_yaml());
  return response;
}

/// Whether the server takes jobs: not while it drains. A full queue passes by itself.
Response readiness(const JobQueue& queue) {
  if (!queue.draining()) return json_response(200, kOk);
  throw RetryLater(ErrorCode::draining, "The server is shutting down; use another.", 1);
}

}  // namespace

void add_info_routes(std::vector<Route>& routes, JobQueue& queue, const api::Limits& limits) {
  routes.push_back({"GET", "/v1/methods", [&limits](const Request&) {
                      return json_response(200, api::methods_json(limits).dump());
                    }});
  routes.push_back({"GET", "/v1/limits", [&limits](const Request&) {
                      return json_response(200, api::to_json(limits).dump());
                    }});
  routes.push_back({"GET", "/openapi.yaml", [](const Request&) { return contract(); }});
  routes.push_back({"GET", "/healthz", [](const Request&) { return json_response(200, kOk); }});
  routes.push_back({"GET", "/readyz", [&queue](const Request&) { return readiness(queue); }});
}

}  // namespace unwrapd::server
