#include "server/info_routes.hpp"

#include "api/openapi.hpp"
#include "api/options.hpp"

namespace unwrapd::server {
namespace {

Response contract() {
  Response response;
  response.content_type = "application/yaml";
  response.body = std::string(api::openapi_yaml());
  return response;
}

}  // namespace

void add_info_routes(std::vector<Route>& routes, const api::Limits& limits) {
  routes.push_back({"GET", "/v1/methods", [&limits](const Request&) {
                      return json_response(200, api::methods_json(limits).dump());
                    }});
  routes.push_back({"GET", "/v1/limits", [&limits](const Request&) {
                      return json_response(200, api::to_json(limits).dump());
                    }});
  routes.push_back({"GET", "/openapi.yaml", [](const Request&) { return contract(); }});
}

}  // namespace unwrapd::server
