#pragma once
// The contract itself, for GET /openapi.yaml: api/openapi.yaml as it was at build time.

#include <string_view>

namespace unwrapd::api {

std::string_view openapi_yaml();

}  // namespace unwrapd::api
