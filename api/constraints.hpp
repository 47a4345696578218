#pragma once
// Positions that vertices shall have, to and from JSON:
//   {"vertex": 17 | "at": [x, y, z], "uv": [u, v], "weight": 2.5, "mesh": 0}
// vertex counts within its mesh; at takes the vertices nearest to a point instead. Without a weight
// (or with null) the position holds exactly. mesh, 0 when not said, counts the asset's meshes.

#include <string>
#include <vector>

#include "api/json.hpp"
#include "core/types/options.hpp"

namespace unwrapd::api {

/// Throws Error{invalid_option} with the pointer, below `pointer`, of what is wrong first.
std::vector<PositionConstraint> constraints_from_json(const Json& json, int most,
                                                      const std::string& pointer);

/// Every member is there but the one of vertex and at that was not given; the weight of a position
/// that holds exactly is null.
Json to_json(const std::vector<PositionConstraint>& constraints);

}  // namespace unwrapd::api
