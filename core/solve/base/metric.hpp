#pragma once
// A mesh given by its edge lengths: its angles, its curvature, and how both change when vertices
// are scaled. Shared by the methods that flatten the metric first and lay it out afterwards (cp,
// bff, ic).

#include <array>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve {

using EdgeLengths = std::array<double, 3>;  ///< of one face; [i] is from corner i to corner i+1

EdgeLengths edge_lengths(const measure::RestTriangle& triangle);

/// The angles at the corners, radians, in (0, pi).
std::array<double, 3> corner_angles(const measure::RestTriangle& triangle);

/// The angle defect of each vertex, radians: 2 pi - the sum of its angles inside, pi - that sum on
/// the boundary. triangles: one a face. The total is 2 pi times the Euler characteristic (Gauss,
/// Bonnet).
std::vector<double> curvature(const Disk& disk, std::span<const measure::RestTriangle> triangles);
std::vector<double> curvature(const Disk& disk, std::span<const measure::RestTriangle> triangles,
                              Executor& executor);

/// The greatest |curvature| of an inner vertex; 0 if there is none.
double inner_curvature(const Disk& disk, std::span<const double> curvature);

/// 1 for the vertices on a boundary loop, else 0.
std::vector<char> boundary_vertices(const Disk& disk);

/// The lower triangle of the cotangent Laplacian, positive semidefinite:
/// (L u)_i = sum over edges of (cot + cot) / 2 (u_i - u_j). When lengths are scaled by exp(u),
/// L u is the change of the curvature, to first order.
linear::SparseMatrix cotan_laplacian(const Disk& disk,
                                     std::span<const measure::RestTriangle> triangles);

/// L x at every vertex, from the lower triangle of L.
std::vector<double> product(const linear::SparseMatrix& laplacian, std::span<const double> x);

/// The rows of a Laplacian that belong to inner vertices, factored once.
class InnerSystem {
 public:
  /// lower: as from cotan_laplacian(). Throws Error{solver_failed, cancelled}.
  InnerSystem(const Disk& disk, const linear::SparseMatrix& lower);

  /// x: one entry a vertex. Boundary entries stay. Inner entries are the right-hand side of L x = b
  /// and become the solution; zeros give the harmonic extension of the boundary. Thread-safe.
  /// Throws Error{cancelled} when the disk's job is cancelled.
  void solve(std::span<Vec2> x) const;

 private:
  struct Coupling {
    Index row;       ///< slot of an inner vertex
    Index boundary;  ///< a neighbour on the boundary
    double value;
  };

  linear::FreeVertices inner_;
  std::vector<Coupling> coupling_;
  std::unique_ptr<linear::RealSystem> system_;
  std::stop_token stop_;
};

/// The logarithmic scale factors, 0 on the boundary, that flatten the inside to first order: L u =
/// -K.
std::vector<double> flat_scales(const Disk& disk, const InnerSystem& inner,
                                std::span<const double> curvature);

}  // namespace unwrapd::solve
