#pragma once
// Sparse matrices of a mesh, assembled in linear time.

#include <Eigen/SparseCore>

#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/mesh/shared_list.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::linear {

/// The index as a std::size_t.
inline std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

/// The lower triangle of the Laplacian of the faces' edges, vertex_count square:
/// (L u)_i = sum over half-edges at i of weight (u_i - u_j). weight has 3 entries a face, one for
/// each side; the two sides of an edge add up. Every vertex has its diagonal entry, stored first.
/// The same bits by any executor. Throws Error{cancelled}.
SparseMatrix lower_laplacian(std::span<const Triangle> faces, Index vertex_count,
                             std::span<const double> weight, Executor& executor);
SparseMatrix lower_laplacian(std::span<const Triangle> faces, Index vertex_count,
                             std::span<const double> weight, const std::stop_token& stop = {});

/// Corners by vertex: the corners (3t+i) of vertex v are corner[begin[v]] .. corner[begin[v+1]-1],
/// ascending. Sums over a vertex in this order are the same for any number of threads.
struct VertexCorners {
  SharedList<Index> begin;   ///< vertex_count + 1 entries
  SharedList<Index> corner;  ///< 3 * face_count entries
};
VertexCorners vertex_corners(std::span<const Triangle> faces, Index vertex_count,
                             const std::stop_token& stop = {});

}  // namespace unwrapd::linear
