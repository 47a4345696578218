#pragma once
// What the server says of itself to everybody: methods, limits, the contract.

#include <string>
#include <vector>

#include "api/limits.hpp"
#include "server/http/router.hpp"

namespace unwrapd::server::routes {

/// downloads: of add_page_routes().
void add_info_routes(std::vector<http::Route>& routes, const api::Limits& limits,
                     const std::string& downloads = {});

}  // namespace unwrapd::server::routes
