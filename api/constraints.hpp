#pragma once
// Position constraints of vertices, to and from JSON:
//   {"vertex": 17 | "at": [x, y, z], "uv": [u, v], "weight": 2.5, "mesh": 0}
// vertex is an index within its mesh; at selects the vertices nearest to a point. Without a weight
// (or with null) the constraint is hard. mesh is an index among the asset's meshes, 0 by default.

#include <string>
#include <vector>

#include "api/json.hpp"
#include "core/types/options.hpp"

namespace unwrapd::api {

/// Throws Error{invalid_option} with the pointer of the first fault, below `pointer`.
std::vector<PositionConstraint> constraints_from_json(const Json& json, int most,
                                                      const std::string& pointer);

/// Has every member except the unused one of vertex and at. The weight of a hard constraint is
/// null.
Json to_json(const std::vector<PositionConstraint>& constraints);

}  // namespace unwrapd::api
