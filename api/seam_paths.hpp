#pragma once
// Edges to cut or to keep, to and from JSON: {"vertices": [3, 4, 9], "mesh": 0} are the edges 3-4
// and 4-9.
// vertices are indices within their mesh; mesh is an index among the asset's meshes, 0 by default.

#include <string>
#include <vector>

#include "api/json.hpp"
#include "core/types/options.hpp"

namespace unwrapd::api {

/// Throws Error{invalid_option} with the pointer of the first fault, below "/<option>".
std::vector<SeamPath> seam_paths_from_json(const Json& json, const std::string& option);

Json to_json(const std::vector<SeamPath>& paths);

}  // namespace unwrapd::api
