#pragma once
// Handlers of texts that are part of the program.

#include <string>
#include <string_view>

#include "server/http/http.hpp"

namespace unwrapd::server::routes {

/// Answers with a text under its ETag; copies are checked before they are used again.
http::Handler text_handler(std::string_view text, std::string_view type);

/// The same for a text that a browser shows. policy: what it may load (Content-Security-Policy).
http::Handler page_handler(std::string_view text, std::string_view type, const std::string& policy);

/// Adds what every answer has that a browser shows.
void protect(http::Response& response, std::string_view policy);

}  // namespace unwrapd::server::routes
