#include "server/routes/info_routes.hpp"

#include "api/openapi.hpp"
#include "api/options.hpp"
#include "server/routes/page_routes.hpp"
#include "server/routes/text_handlers.hpp"

namespace unwrapd::server::routes {
namespace {

/// The page of the contract loads nothing from other sites and runs no scripts, whatever is
/// injected into it.
constexpr std::string_view kDocsPolicy =
    "default-src 'none'; style-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";
constexpr std::string_view kHtml = "text/html; charset=utf-8";
constexpr std::string_view kCss = "text/css; charset=utf-8";

}  // namespace

void add_info_routes(std::vector<http::Route>& routes, const api::Limits& limits) {
  routes.push_back({"GET", "/v1/methods", [&limits](const http::Request&) {
                      return http::json_response(200, api::methods_json(limits).dump());
                    }});
  routes.push_back({"GET", "/v1/limits", [&limits](const http::Request&) {
                      return http::json_response(200, api::to_json(limits).dump());
                    }});
  routes.push_back({"GET", "/openapi.yaml", text_handler(api::openapi_yaml(), "application/yaml")});
  routes.push_back({"GET", "/openapi.json", text_handler(api::openapi_json(), "application/json")});
  routes.push_back({"GET", "/docs", page_handler(api::docs_html(), kHtml, kDocsPolicy)});
  routes.push_back({"GET", "/docs.css", page_handler(api::docs_css(), kCss, kDocsPolicy)});
  add_page_routes(routes);
}

}  // namespace unwrapd::server::routes
