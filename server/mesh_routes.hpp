#pragma once
// The calls on stored meshes.

#include <chrono>
#include <vector>

#include "server/meshes.hpp"
#include "server/router.hpp"

namespace unwrapd::server {

/// kept: for so long after they were used.
void add_mesh_routes(std::vector<Route>& routes, Meshes& meshes, std::chrono::seconds kept);

}  // namespace unwrapd::server
