#pragma once
// The contract itself as the server answers it: api/openapi.yaml as it was at build time, and what
// was made of it then (api/contract/).

#include <string_view>

namespace unwrapd::api {

std::string_view openapi_yaml();
std::string_view openapi_json();  ///< the same, on one line
std::string_view docs_html();     ///< the same for people; it refers to docs.css beside it
std::string_view docs_css();

}  // namespace unwrapd::api
