#pragma once
// The calls on stored meshes.

#include <chrono>
#include <vector>

#include "server/http/router.hpp"
#include "server/uploads/meshes.hpp"

namespace unwrapd::server::routes {

/// kept: for so long after they were used.
void add_mesh_routes(std::vector<http::Route>& routes, uploads::Meshes& meshes,
                     std::chrono::seconds kept);

}  // namespace unwrapd::server::routes
