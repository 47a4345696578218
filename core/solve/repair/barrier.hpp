#pragma once
// An energy that prevents flips, or turns flipped triangles back: the method's own energy, plus a
// term that grows without bound as a triangle's area goes to zero.

#include <array>
#include <limits>
#include <span>
#include <stop_token>
#include <vector>

#include "core/linear/eliminate.hpp"
#include "core/solve/arap/local_step.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/solve/repair/profile.hpp"

namespace unwrapd::solve::repair {

/// E = sum A_t [ own(J_t) + weight wall(J_t) + steep wall^4(J_t) + dirichlet SD(J_t) ],
/// wall and SD, the symmetric Dirichlet energy, as in profile.hpp, and w |u_v - at|^2 for every
/// soft constraint.
struct Barrier {
  arap::Rigidity rigidity;  ///< for OwnEnergy::fit
  double weight = 1;
  double epsilon = 0;    ///< 0: infinite unless every triangle is positive
  double dirichlet = 0;  ///< weight of SD, which rises faster than the wall; then epsilon is 0
  double steep = 0;      ///< bounds the stretch; nearly zero for small stretch
  OwnEnergy own = OwnEnergy::fit;
};

/// Bytes of a job: those in use otherwise, and the limit.
struct JobMemory {
  std::size_t taken = 0;
  std::size_t limit = std::numeric_limits<std::size_t>::max();
};

/// The triangles around the free vertices. Vertices are numbered locally.
struct BarrierMesh {
  std::vector<Triangle> faces;
  std::vector<measure::RestTriangle> rest;  ///< one a face: its target shape and size
  linear::FreeVertices free;                ///< one slot a vertex
  std::vector<SoftConstraint> soft = {};
  std::stop_token stop = {};       ///< cancels loops over all faces (cancel.hpp)
  std::vector<double> share = {};  ///< A_t in the energy, one a face; empty: that of rest
  JobMemory memory = {};           ///< checked before Newton's factor is allocated
};

/// The same shape at another size. It has only the members that a barrier reads of its target.
inline measure::RestTriangle scaled(measure::RestTriangle rest, double by) {
  for (Vec2& edge : rest.edge) edge *= by;
  rest.area *= by * by;
  return rest;
}

/// Gradient and projected Hessian of one triangle, by the coordinates of its corners.
struct BarrierElement {
  Eigen::Matrix<double, 6, 1> gradient;
  Eigen::Matrix<double, 6, 6> hessian;
};

/// Of face t.
BarrierElement barrier_element(const BarrierMesh& mesh, std::size_t t, std::span<const Vec2> uv,
                               const Barrier& barrier);

/// Throws Error{cancelled}, as do all functions below.
double barrier_energy(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier);

/// The least determinant of the triangles' Jacobians.
double least_determinant(const BarrierMesh& mesh, std::span<const Vec2> uv);

/// Gradient and the lower triangle of a positive semidefinite Hessian: unknowns 2s and 2s+1 are u
/// and v of slot s. Each triangle's Hessian is projected exactly.
struct Quadratic {
  Eigen::VectorXd gradient;
  linear::SparseMatrix hessian;
  /// Positions of the lower triangle of each face's Hessian, by rows, among the values of hessian;
  /// -1: not stored.
  std::vector<std::array<Index, 21>> place;

  [[nodiscard]] std::size_t bytes() const;
};

/// The pattern with zeros, which may be refilled any number of times. It depends on the mesh alone.
Quadratic barrier_pattern(const BarrierMesh& mesh);

/// model: from barrier_pattern() of the same mesh.
void fill_barrier_model(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier,
                        Quadratic& model);

}  // namespace unwrapd::solve::repair
