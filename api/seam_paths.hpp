#pragma once
// Edges to be cut open, to and from JSON: {"vertices": [3, 4, 9], "mesh": 0} cuts the edges 3-4 and
// 4-9. vertices count within their mesh; mesh, 0 when not said, counts the asset's meshes.

#include <string>
#include <vector>

#include "api/json.hpp"
#include "core/types/options.hpp"

namespace unwrapd::api {

/// Throws Error{invalid_option} with the pointer, below `pointer`, of what is wrong first.
std::vector<SeamPath> seam_paths_from_json(const Json& json, const std::string& pointer);

Json to_json(const std::vector<SeamPath>& paths);

}  // namespace unwrapd::api
