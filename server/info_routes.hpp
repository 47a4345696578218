#pragma once
// What the server says of itself: methods, limits, the contract, and whether it is well.

#include <vector>

#include "api/limits.hpp"
#include "server/job_queue.hpp"
#include "server/router.hpp"

namespace unwrapd::server {

void add_info_routes(std::vector<Route>& routes, JobQueue& queue, const api::Limits& limits);

}  // namespace unwrapd::server
