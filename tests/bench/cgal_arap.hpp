#pragma once
// CGAL's ARAP parameterizer, as a yardstick. CGAL is GPL: it is linked here and nowhere else.

#include <optional>

#include "core/measure/distortion.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// Ten iterations of CGAL::Surface_mesh_parameterization::ARAP_parameterizer_3 from its own
/// mean-value start, no early stop. Seconds of the processor for the parameterization alone (its
/// mesh is built before); nothing when CGAL ends in an error or is not
/// linked. uv gets one entry a vertex.
std::optional<double> cgal_arap_seconds(const TriMesh& mesh, UvMap& uv);

}  // namespace unwrapd::bench
