#pragma once
// The page at / and the files that it loads.

#include <vector>

#include "server/http/router.hpp"

namespace unwrapd::server::routes {

void add_page_routes(std::vector<http::Route>& routes);

}  // namespace unwrapd::server::routes
