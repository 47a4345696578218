#pragma once
// What the server says of itself to everybody: methods, limits, the contract.

#include <vector>

#include "api/limits.hpp"
#include "server/http/router.hpp"

namespace unwrapd::server {

void add_info_routes(std::vector<Route>& routes, const api::Limits& limits);

}  // namespace unwrapd::server
