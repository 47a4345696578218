#pragma once
// An energy that keeps triangles from flipping, or turns flipped ones back: the method's own, plus
// a term that grows without bound as a triangle's area goes to zero.

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
  arap::Rigidity rigidity;  ///< of OwnEnergy::fit
  double weight = 1;
  double epsilon = 0;    ///< 0: infinite unless every triangle is positive
  double dirichlet = 0;  ///< steeper than the wall; epsilon is 0
  double steep = 0;      ///< bounds stretch, and hardly moves what is stretched less
  OwnEnergy own = OwnEnergy::fit;
};

/// Bytes of a job: those that it takes anyhow, and those that it may take.
struct JobMemory {
  std::size_t taken = 0;
  std::size_t limit = std::numeric_limits<std::size_t>::max();
};

/// Triangles whose free vertices are to be moved. Vertices are numbered by faces.
struct BarrierMesh {
  std::vector<Triangle> faces;
  std::vector<measure::RestTriangle> rest;  ///< one a face: the shape and size that it should have
  linear::FreeVertices free;                ///< one slot a vertex
  std::vector<SoftConstraint> soft = {};
  std::stop_token stop = {};  ///< of the job: what goes over all faces looks at it (cancel.hpp)
  std::vector<double> share = {};  ///< A_t in the energy, one a face; empty: that of rest
  JobMemory memory = {};           ///< that Newton's factor is looked at for
};

/// The same shape, larger or smaller: all that a barrier's target is looked at for.
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

/// Throws Error{cancelled}, as all below.
double barrier_energy(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier);

/// The least determinant of the triangles' Jacobians.
double least_determinant(const BarrierMesh& mesh, std::span<const Vec2> uv);

/// Gradient and the lower triangle of a positive semidefinite Hessian: unknowns 2s and 2s+1 are u
/// and v of slot s. Each triangle's Hessian is projected exactly.
struct Quadratic {
  Eigen::VectorXd gradient;
  linear::SparseMatrix hessian;
  /// Where the lower triangle of each face's Hessian goes, by rows, among the values of hessian;
  /// -1: nowhere.
  std::vector<std::array<Index, 21>> place;

  [[nodiscard]] std::size_t bytes() const;
};

/// All zeros, to be refilled as often as one likes: the pattern depends on the mesh alone.
Quadratic barrier_pattern(const BarrierMesh& mesh);

/// model: from barrier_pattern() of the same mesh.
void fill_barrier_model(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier,
                        Quadratic& model);

}  // namespace unwrapd::solve::repair
