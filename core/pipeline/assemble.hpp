#pragma once
// Charts' maps back onto the surface that they were cut from.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::pipeline {

/// How charts' vertices become vertices of the surface: see assemble().
struct VertexPlan {
  std::vector<Triangle> faces;  ///< as UnwrappedSurface's
  std::vector<Index> source;    ///< as UnwrappedSurface's
  std::vector<Index> shown;  ///< of each: which vertex of all charts, in their order, or kUncharted
};

std::size_t bytes_of(const VertexPlan& plan);

/// charts: those of the surface, or what became of them; whole tells what is set aside. Throws
/// Error{cancelled}.
VertexPlan plan_vertices(const Surface& surface, const charts::Charts& whole,
                         std::span<const charts::Chart* const> charts,
                         const std::stop_token& stop = {});

std::vector<const charts::Chart*> pointers_to(std::span<const charts::Chart> charts);

/// Charts' page UVs back onto the surface's vertices: splits those that lie on a seam. A vertex's
/// first corner keeps its number, copies are appended in the order of faces and corners. Faces that
/// were set aside get their UVs by place_set_aside(), (0,0) where they touch no chart. Throws
/// Error{cancelled}.
UnwrappedSurface assemble(const Surface& surface, const charts::Charts& charts,
                          std::span<const UvMap> chart_uv, const std::stop_token& stop = {});

/// The same by a plan that is made already.
UnwrappedSurface assemble(const VertexPlan& plan, std::span<const UvMap> chart_uv);

}  // namespace unwrapd::pipeline
