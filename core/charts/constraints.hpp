#pragma once
// Converts the user's constraints (Sec. 7) to constraints of each chart's vertices.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/types/options.hpp"

namespace unwrapd::charts {

/// The constraints of every chart, in the page's coordinates (UVs): result[s][k] for chart k of
/// surface s. All are empty if there are no constraints; else each has at least one vertex.
///
/// A constraint applies to one vertex in each chart in which its vertex occurs. If it names a point
/// in space, its vertex is the nearest one; of equally near ones the lowest. If a cut runs through
/// the vertex, the constraint applies to the copy at the lowest corner of a face. Constraints of
/// one vertex with the same uv are one; soft ones add up; a hard one makes soft ones of no effect.
/// UVs are compared as the 32-bit floats that are written.
///
/// Throws Error{invalid_constraint}, where = "/constraints/<i>": no such surface or vertex; a
/// vertex in no face; one vertex with two positions; two vertices with one; a chart whose targets
/// are all equal; a weight out of bounds; a uv beyond 32-bit floats. where = "/constraints": a
/// chart that has none. Throws Error{cancelled}.
std::vector<std::vector<solve::VertexConstraints>> page_constraints(
    std::span<const Surface> surfaces, std::span<const Charts> charts,
    std::span<const PositionConstraint> constraints, const std::stop_token& stop);

}  // namespace unwrapd::charts
