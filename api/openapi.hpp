#pragma once
// The contract as the server answers it: api/openapi.yaml at build time, and the same as JSON,
// with its examples (api/contract/).

#include <string_view>

namespace unwrapd::api {

std::string_view openapi_yaml();
std::string_view openapi_json();  ///< the same, on one line

}  // namespace unwrapd::api
