#pragma once
// The page at / and the files that it loads.

#include <string>
#include <vector>

#include "server/http/router.hpp"

namespace unwrapd::server::routes {

/// downloads: the other server that results are redirected to, "https://host"; empty: none.
void add_page_routes(std::vector<http::Route>& routes, const std::string& downloads);

}  // namespace unwrapd::server::routes
