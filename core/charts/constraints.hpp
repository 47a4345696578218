#pragma once
// What a user wants held (Sec. 7), as holds of each chart's vertices.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/types/options.hpp"

namespace unwrapd::charts {

/// The holds of every chart, in the page's coordinates: result[s][k] for chart k of surface s. All
/// are empty when there are no constraints; else each has at least one vertex.
///
/// A constraint holds one vertex in each chart in which its vertex occurs (given by position: in
/// which a vertex occurs at the place nearest to it; of places equally near, that of the lowest
/// vertex). Where a cut runs through that vertex, it is the one that the lowest corner of a face
/// shows. Constraints of one vertex with the same uv are one; soft ones add up; a hard one makes
/// soft ones of no effect. UVs are compared as the 32-bit floats that are written.
///
/// Throws Error{invalid_constraint}, where = "/constraints/<i>": no such surface or vertex; a
/// vertex in no face; one vertex at two places; two vertices at one; a chart all of whose targets
/// are one; a weight out of bounds; a uv beyond 32-bit floats. where = "/constraints": a chart that
/// has none. Throws Error{cancelled}.
std::vector<std::vector<solve::VertexConstraints>> page_constraints(
    std::span<const Surface> surfaces, std::span<const Charts> charts,
    std::span<const PositionConstraint> constraints, const std::stop_token& stop);

}  // namespace unwrapd::charts
