#include "server/info_routes.hpp"

#include "api/openapi.hpp"
#include "api/options.hpp"
#include "server/identity.hpp"
#include "server/result_routes.hpp"

namespace unwrapd::server {
namespace {

/// Nothing is run and nothing comes from elsewhere, whatever should get into the page.
constexpr const char* kPagePolicy =
    "default-src 'none'; style-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

/// A text that is part of the program, with its ETag.
Handler text_handler(std::string_view text, std::string_view type) {
  return [text, type, etag = "\"" + sha256(text) + "\""](const Request& request) {
    Response response;
    response.headers = {{"ETag", etag}, {"Cache-Control", "no-cache"}};
    if (has_copy(request, etag)) {
      response.status = 304;
      return response;
    }
    response.content_type = type;
    response.body = std::string(text);
    return response;
  };
}

Handler page_handler(std::string_view text, std::string_view type) {
  return [answer = text_handler(text, type)](const Request& request) {
    Response response = answer(request);
    response.headers.emplace_back("Content-Security-Policy", kPagePolicy);
    response.headers.emplace_back("X-Content-Type-Options", "nosniff");
    response.headers.emplace_back("Referrer-Policy", "no-referrer");
    return response;
  };
}

}  // namespace

void add_info_routes(std::vector<Route>& routes, const api::Limits& limits) {
  routes.push_back({"GET", "/v1/methods", [&limits](const Request&) {
                      return json_response(200, api::methods_json(limits).dump());
                    }});
  routes.push_back({"GET", "/v1/limits", [&limits](const Request&) {
                      return json_response(200, api::to_json(limits).dump());
                    }});
  routes.push_back({"GET", "/openapi.yaml", text_handler(api::openapi_yaml(), "application/yaml")});
  routes.push_back({"GET", "/openapi.json", text_handler(api::openapi_json(), "application/json")});
  routes.push_back({"GET", "/docs", page_handler(api::docs_html(), "text/html; charset=utf-8")});
  routes.push_back({"GET", "/docs.css", page_handler(api::docs_css(), "text/css; charset=utf-8")});
}

}  // namespace unwrapd::server
