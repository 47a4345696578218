#pragma once
// The result of a job as one JSON document: the report and the meshes inline.

#include <span>
#include <string>

#include "api/json.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::api {

/// {report, meshes: [{name, positions, uv, faces, vertex_map}]}. positions are flat x y z, uv flat
/// u v with V pointing up (glTF's points down), faces flat vertex indices; vertex_map[v] is the
/// input vertex that vertex v copies. Numbers are the shortest that read back as the same double.
/// surfaces and unwrapped have one entry a mesh, in the same order.
std::string result_json(const Json& report, std::span<const Surface> surfaces,
                        std::span<const UnwrappedSurface> unwrapped);

}  // namespace unwrapd::api
