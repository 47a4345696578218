#pragma once
// An energy that keeps triangles from flipping, or turns flipped ones back: the method's own, plus
// a term that grows without bound as a triangle's area goes to zero.

#include <array>
#include <span>
#include <stop_token>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/solve/holds.hpp"
#include "core/solve/local_step.hpp"

namespace unwrapd {

/// E = sum A_t [ fit(J_t) + weight (|J_t|^2 / 2 + (1 + det^2 J_t) / 2) / chi(det J_t) - 2 weight ]
/// with chi(d) = (d + sqrt(epsilon^2 + d^2)) / 2, plus dirichlet (|J_t|^2 + |J_t^-1|^2 - 4) in the
/// bracket, and w |u_v - at|^2 for every spring. fit: the method's energy, Eq. (5).
struct Barrier {
  Rigidity rigidity;
  double weight = 1;
  double epsilon = 0;    ///< 0: infinite unless every triangle is positive
  double dirichlet = 0;  ///< of the symmetric Dirichlet energy, steeper than the wall; epsilon is 0
};

/// Triangles whose free vertices are to be moved. Vertices are numbered by faces.
struct BarrierMesh {
  std::vector<Triangle> faces;
  std::vector<RestTriangle> rest;  ///< one a face: the shape and size that it should have
  FreeVertices free;               ///< one slot a vertex
  std::vector<Spring> springs = {};
  std::stop_token stop = {};  ///< of the job: what goes over all faces looks at it (cancel.hpp)
};

/// The same shape, larger or smaller: all that a barrier's target is looked at for.
inline RestTriangle scaled(RestTriangle rest, double by) {
  for (Vec2& edge : rest.edge) edge *= by;
  rest.area *= by * by;
  return rest;
}

/// Throws Error{cancelled}, as all below.
double barrier_energy(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier);

/// The least determinant of the triangles' Jacobians.
double least_determinant(const BarrierMesh& mesh, std::span<const Vec2> uv);

/// Gradient and the lower triangle of a positive semidefinite Hessian: unknowns 2s and 2s+1 are u
/// and v of slot s. Each triangle's Hessian is projected exactly.
struct Quadratic {
  Eigen::VectorXd gradient;
  SparseMatrix hessian;
  /// Where the lower triangle of each face's Hessian goes, by rows, among the values of hessian;
  /// -1: nowhere.
  std::vector<std::array<Index, 21>> place;
};

/// All zeros, to be refilled as often as one likes: the pattern depends on the mesh alone.
Quadratic barrier_pattern(const BarrierMesh& mesh);

/// model: from barrier_pattern() of the same mesh.
void fill_barrier_model(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier,
                        Quadratic& model);

}  // namespace unwrapd
