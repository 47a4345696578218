#include "server/routes/info_routes.hpp"

#include "api/openapi.hpp"
#include "api/options.hpp"
#include "client/web/page.hpp"
#include "server/base/identity.hpp"
#include "server/routes/result_routes.hpp"

namespace unwrapd::server::routes {
namespace {

/// Pages load nothing from other sites, whatever is injected into them; the page of the contract
/// runs no scripts.
constexpr std::string_view kDocsPolicy =
    "default-src 'none'; style-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";
constexpr std::string_view kPagePolicy =
    "default-src 'none'; style-src 'self'; script-src 'self'; connect-src 'self'; "
    "img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr std::string_view kHtml = "text/html; charset=utf-8";
constexpr std::string_view kCss = "text/css; charset=utf-8";
constexpr std::string_view kScript = "text/javascript; charset=utf-8";

/// A text that is part of the program, with its ETag.
http::Handler text_handler(std::string_view text, std::string_view type) {
  return [text, type, etag = "\"" + sha256(text) + "\""](const http::Request& request) {
    http::Response response;
    if (has_copy(request, etag)) {
      response = not_modified(request, etag, type);
    } else {
      response.content_type = type;
      response.headers = {{"ETag", etag}};
      response.body = std::string(text);
    }
    response.headers.emplace_back("Cache-Control", "no-cache");
    return response;
  };
}

/// A text that a browser shows or runs.
http::Handler page_handler(std::string_view text, std::string_view type, std::string_view policy) {
  return [answer = text_handler(text, type), policy](const http::Request& request) {
    http::Response response = answer(request);
    response.headers.emplace_back("Content-Security-Policy", policy);
    response.headers.emplace_back("X-Content-Type-Options", "nosniff");
    response.headers.emplace_back("Referrer-Policy", "no-referrer");
    return response;
  };
}

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
  routes.push_back({"GET", "/", page_handler(web::index_html(), kHtml, kPagePolicy)});
  routes.push_back({"GET", "/form.js", page_handler(web::form_js(), kScript, kPagePolicy)});
  routes.push_back({"GET", "/page.css", page_handler(web::page_css(), kCss, kPagePolicy)});
  routes.push_back({"GET", "/page.js", page_handler(web::page_js(), kScript, kPagePolicy)});
}

}  // namespace unwrapd::server::routes
