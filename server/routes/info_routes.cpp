#include "server/routes/info_routes.hpp"

#include "api/openapi.hpp"
#include "api/options.hpp"
#include "server/routes/page_routes.hpp"
#include "server/routes/text_handlers.hpp"

namespace unwrapd::server::routes {
void add_info_routes(std::vector<http::Route>& routes, const api::Limits& limits,
                     const std::string& downloads) {
  routes.push_back({"GET", "/v1/methods", [&limits](const http::Request&) {
                      return http::json_response(200, api::methods_json(limits).dump());
                    }});
  routes.push_back({"GET", "/v1/limits", [&limits](const http::Request&) {
                      return http::json_response(200, api::to_json(limits).dump());
                    }});
  routes.push_back({"GET", "/openapi.yaml", text_handler(api::openapi_yaml(), "application/yaml")});
  routes.push_back({"GET", "/openapi.json", text_handler(api::openapi_json(), "application/json")});
  add_page_routes(routes, downloads);
}

}  // namespace unwrapd::server::routes
