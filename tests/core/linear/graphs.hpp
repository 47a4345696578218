#pragma once
// Graphs to order: who is coupled with whom on a mesh.

#include "core/linear/ordering.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::linear {

inline SparseMatrix unit_laplacian(const TriMesh& mesh) {
  return lower_laplacian(mesh.faces, mesh.vertex_count(),
                         std::vector<double>(3 * mesh.faces.size(), 1.0));
}

inline Graph graph_of(const SparseMatrix& lower) {
  return graph_of_lower({lower.outerIndexPtr(), std::size_t(lower.cols()) + 1},
                        {lower.innerIndexPtr(), std::size_t(lower.nonZeros())});
}

inline Graph graph_of(const TriMesh& mesh) { return graph_of(unit_laplacian(mesh)); }

}  // namespace unwrapd::linear
