#pragma once
// The contract as the server answers it: api/openapi.yaml at build time, and the documents made
// from it (api/contract/).

#include <string_view>

namespace unwrapd::api {

std::string_view openapi_yaml();
std::string_view openapi_json();  ///< the same, on one line
std::string_view docs_html();     ///< the same as a page; it refers to docs.css beside it
std::string_view docs_css();

}  // namespace unwrapd::api
