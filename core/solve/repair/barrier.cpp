// Energies are functions F(Q, R) of the Jacobian's similarity part (e, h) and its rest (f, g)
// (profile.hpp). In these coordinates the Hessian falls apart: F_Q / Q and F_R / R act across
// (e, h) and (f, g), and a 2 by 2 block acts along them. Clamping those four eigenvalues projects
// it without an SVD (compare Smith, de Goes, Kim 2019).
#include "core/solve/repair/barrier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/cancel.hpp"
#include "core/linear/pair_system.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/repair/profile.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

Profile own_profile(double q, double r, double area, const Barrier& barrier) {
  switch (barrier.own) {
    case OwnEnergy::symmetric_dirichlet:
      return symmetric_dirichlet_profile(q, r);
    case OwnEnergy::mips:
      return mips_profile(q, r);
    default:
      return fit_profile(q, r, barrier.rigidity.at(area));
  }
}

/// Adds w p to a sum.
void add_weighted(double w, const Profile& p, Profile& sum) {
  sum.value += w * p.value;
  sum.q += w * p.q;
  sum.r += w * p.r;
  sum.qq += w * p.qq;
  sum.qr += w * p.qr;
  sum.rr += w * p.rr;
}

Profile profile(const measure::Jacobian& j, double area, const Barrier& barrier) {
  const double q = j.turn_scale(), r = j.deformation();
  Profile p = own_profile(q, r, area, barrier);
  if (barrier.dirichlet > 0) add_weighted(barrier.dirichlet, symmetric_dirichlet_profile(q, r), p);
  if (!(barrier.weight > 0 || barrier.steep > 0)) return p;
  const Profile wall = wall_profile(q, r, barrier.epsilon);
  add_weighted(barrier.weight, wall, p);
  if (barrier.steep > 0) add_weighted(barrier.steep, fourth_power(wall), p);
  return p;
}

using Rows = Eigen::Matrix<double, 4, 6>;  // (e, h, f, g) by (u, v) of the three corners

Rows rows_of(const measure::RestTriangle& rest) {
  Rows rows;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vec2& facing = rest.edge[static_cast<std::size_t>((i + 1) % 3)];
    const double x = facing.y() / (4 * rest.area), y = -facing.x() / (4 * rest.area);
    rows.block<4, 2>(0, 2 * i) << x, y, -y, x, x, -y, y, x;
  }
  return rows;
}

Vec2 unit(double x, double y, double length) {
  return length > 0 ? Vec2(x / length, y / length) : Vec2(1, 0);
}

BarrierElement element(const measure::Jacobian& j, const measure::RestTriangle& rest, double share,
                       const Barrier& barrier) {
  Profile p = profile(j, rest.area, barrier);
  const double q = j.turn_scale(), r = j.deformation();
  const Vec2 along_q = unit(j.e, j.h, q), along_r = unit(j.f, j.g, r);
  const Vec2 across_q(-along_q.y(), along_q.x()), across_r(-along_r.y(), along_r.x());
  const double turn = q > 0 ? std::max(0.0, p.q / q) : 0;
  const double twist = r > 0 ? std::max(0.0, p.r / r) : std::max(0.0, p.rr);
  project(p);
  Eigen::Vector4d slope;
  slope << p.q * along_q, p.r * along_r;
  Eigen::Matrix4d bend;
  bend.topLeftCorner<2, 2>() =
      p.qq * along_q * along_q.transpose() + turn * across_q * across_q.transpose();
  bend.bottomRightCorner<2, 2>() =
      p.rr * along_r * along_r.transpose() + twist * across_r * across_r.transpose();
  bend.topRightCorner<2, 2>() = p.qr * along_q * along_r.transpose();
  bend.bottomLeftCorner<2, 2>() = bend.topRightCorner<2, 2>().transpose();
  const Rows rows = rows_of(rest);
  return {share * rows.transpose() * slope, share * rows.transpose() * bend * rows};
}

measure::Jacobian jacobian_of(const BarrierMesh& mesh, std::size_t t, std::span<const Vec2> uv) {
  return measure::jacobian(mesh.rest[t], measure::uv_edges(mesh.faces[t], uv));
}

double share_of(const BarrierMesh& mesh, std::size_t t) {
  return mesh.share.empty() ? mesh.rest[t].area : mesh.share[t];
}

/// By the exact test, and by the rounded determinant, since the barrier divides by it.
bool is_positive(const measure::Jacobian& j, const Triangle& face, std::span<const Vec2> uv) {
  return (j.turn_scale() - j.deformation()) * j.sigma_max() > 0 &&
         measure::orientation(face, uv) > 0;
}

/// The index of corner coordinate k (of 6) among the unknowns; negative if the vertex is fixed.
Index unknown(const BarrierMesh& mesh, std::size_t t, Index k) {
  const Index slot =
      mesh.free.slot[static_cast<std::size_t>(mesh.faces[t][static_cast<std::size_t>(k / 2)])];
  return slot == linear::kFixed ? linear::kFixed : 2 * slot + k % 2;
}

/// The diagonal comes first in every column.
void add_soft_constraints(const BarrierMesh& mesh, std::span<const Vec2> uv, Quadratic& model) {
  for (const SoftConstraint& soft_constraint : mesh.soft) {
    const Index slot = mesh.free.slot[static_cast<std::size_t>(soft_constraint.vertex)];
    if (slot == linear::kFixed) continue;
    const Vec2 away = uv[static_cast<std::size_t>(soft_constraint.vertex)] - soft_constraint.at;
    for (Index k = 0; k < 2; ++k) {
      model.gradient[2 * slot + k] += 2 * soft_constraint.weight * away[k];
      model.hessian.valuePtr()[model.hessian.outerIndexPtr()[2 * slot + k]] +=
          2 * soft_constraint.weight;
    }
  }
}

void add_lower(const Eigen::Matrix<double, 6, 6>& hessian, const std::array<Index, 21>& places,
               double* values) {
  const Index* place = places.data();
  for (Index a = 0; a < 6; ++a)
    for (Index b = 0; b <= a; ++b, ++place)
      if (*place != linear::kFixed) values[*place] += hessian(a, b);
}

}  // namespace

std::size_t Quadratic::bytes() const {
  const auto entries = static_cast<std::size_t>(hessian.nonZeros());
  const auto columns = static_cast<std::size_t>(hessian.cols());
  return entries * (sizeof(double) + sizeof(Index)) + columns * (sizeof(double) + sizeof(Index)) +
         place.size() * sizeof(place[0]);
}

BarrierElement barrier_element(const BarrierMesh& mesh, std::size_t t, std::span<const Vec2> uv,
                               const Barrier& barrier) {
  return element(jacobian_of(mesh, t, uv), mesh.rest[t], share_of(mesh, t), barrier);
}

double barrier_energy(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier) {
  double energy = soft_constraint_energy(mesh.soft, uv);
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    check_cancelled_every(t, mesh.stop);
    const measure::Jacobian j = jacobian_of(mesh, t, uv);
    if (barrier.epsilon == 0 && !is_positive(j, mesh.faces[t], uv)) return kFar;
    energy += share_of(mesh, t) * profile(j, mesh.rest[t].area, barrier).value;
  }
  return energy;
}

double least_determinant(const BarrierMesh& mesh, std::span<const Vec2> uv) {
  double least = kFar;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    check_cancelled_every(t, mesh.stop);
    least = std::min(least, jacobian_of(mesh, t, uv).determinant());
  }
  return least;
}

Quadratic barrier_pattern(const BarrierMesh& mesh) {
  const Index size = 2 * mesh.free.count;
  Quadratic model{
      Eigen::VectorXd::Zero(size), linear::pair_pattern(mesh.faces, mesh.free, mesh.stop), {}};
  model.place.resize(mesh.faces.size());
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    check_cancelled_every(t, mesh.stop);
    std::size_t k = 0;
    for (Index a = 0; a < 6; ++a)
      for (Index b = 0; b <= a; ++b, ++k) {
        const auto [column, row] = std::minmax({unknown(mesh, t, a), unknown(mesh, t, b)});
        model.place[t][k] = column == linear::kFixed ? linear::kFixed
                                                     : linear::entry_of(model.hessian, row, column);
      }
  }
  return model;
}

void fill_barrier_model(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier,
                        Quadratic& model) {
  model.gradient.setZero();
  double* values = model.hessian.valuePtr();
  std::fill_n(values, model.hessian.nonZeros(), 0.0);
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    check_cancelled_every(t, mesh.stop);
    const BarrierElement e = barrier_element(mesh, t, uv, barrier);
    for (Index a = 0; a < 6; ++a) {
      const Index row = unknown(mesh, t, a);
      if (row != linear::kFixed) model.gradient[row] += e.gradient[a];
    }
    add_lower(e.hessian, model.place[t], values);
  }
  add_soft_constraints(mesh, uv, model);
}

}  // namespace unwrapd::solve::repair
