#pragma once
// Islands that are not packed, to and from JSON: {"face": 7, "mesh": 0, "turn": 90, "move": [0.25,
// 0]} is the island of texture coordinates that face 7 lies in, turned counterclockwise and then
// moved. faces are triangles of their mesh; mesh is an index among the asset's meshes, 0 by
// default; turn is in degrees, move in UVs, and both are 0 by default.

#include <string>
#include <vector>

#include "api/json.hpp"
#include "core/types/options.hpp"

namespace unwrapd::api {

/// Throws Error{invalid_option} with the pointer of the first fault, below `pointer`.
std::vector<LockedIsland> locked_islands_from_json(const Json& json, const std::string& pointer);

Json to_json(const std::vector<LockedIsland>& islands);

}  // namespace unwrapd::api
