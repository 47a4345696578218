#include "server/routes/text_handlers.hpp"

#include "server/base/identity.hpp"
#include "server/routes/result_routes.hpp"

namespace unwrapd::server::routes {

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

http::Handler page_handler(std::string_view text, std::string_view type,
                           const std::string& policy) {
  return [answer = text_handler(text, type), policy](const http::Request& request) {
    http::Response response = answer(request);
    protect(response, policy);
    return response;
  };
}

void protect(http::Response& response, std::string_view policy) {
  response.headers.emplace_back("Content-Security-Policy", policy);
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
}

}  // namespace unwrapd::server::routes
