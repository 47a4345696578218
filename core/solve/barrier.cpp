// The regularised barrier of Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, "Foldover-Free
// Maps in 50 Lines of Code", SIGGRAPH 2021, added to the paper's energies.
//
// Both are functions F(Q, R) of the Jacobian's similarity part (e, h), Q = |(e, h)|, and its rest
// (f, g), R = |(f, g)|, in which det J = Q^2 - R^2. In these coordinates the Hessian falls apart:
// F_Q / Q and F_R / R act across (e, h) and (f, g), and a 2 by 2 block acts along them. Clamping
// those four eigenvalues projects it without an SVD (compare Smith, de Goes, Kim 2019).
#include "core/solve/barrier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cancel.hpp"
#include "core/linear/pair_system.hpp"
#include "core/measure/orientation.hpp"

namespace unwrapd {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// A function of Q and R with its derivatives.
struct Profile {
  double value = 0;
  double q = 0, r = 0;
  double qq = 0, qr = 0, rr = 0;
};

/// chi and its two derivatives.
struct Chi {
  double value, slope, bend;
};

Chi chi_of(double d, double epsilon) {
  const double root = std::sqrt(epsilon * epsilon + d * d);
  const double value = d > 0 ? (d + root) / 2 : epsilon * epsilon / (2 * (root - d));
  if (!(root > 0)) return {0, 1, 0};
  const double share = epsilon / root;
  return {value, (1 + d / root) / 2, share * share / (2 * root)};
}

/// The scale of the similarity that fits (q, 0) best, without a root where it is known.
double fitted_scale(double q, double lambda) {
  if (lambda == 0) return q;
  if (std::isinf(lambda)) return 1;
  return fit_similarity({q, 0, 0, 0}, lambda).a;
}

/// min over r of 2 (Q - r)^2 + lambda (r^2 - 1)^2, plus 2 R^2.
Profile fit_profile(double q, double r, double lambda) {
  const Jacobian along{q, 0, r, 0};
  const double scale = fitted_scale(q, lambda);
  const double stiffness = 1 / (1 + 1 / (lambda * (3 * scale * scale - 1)));
  Profile p;
  p.value = fit_energy(along, {scale, 0}, 1, lambda);
  p.q = 4 * (q - scale);
  p.r = 4 * r;
  p.qq = 4 * stiffness;
  p.rr = 4;
  return p;
}

/// (Q^2 + R^2 + (1 + d^2) / 2) / chi(d) - 2 with d = Q^2 - R^2: at least 0, and 0 for rotations.
Profile wall_profile(double q, double r, double epsilon) {
  const double d = (q - r) * (q + r);
  const Chi chi = chi_of(d, epsilon);
  const double n = q * q + r * r + (1 + d * d) / 2;
  const double part = 1 / chi.value;
  const double b = n * part;
  Profile p;
  p.value = b - 2;
  const double chi_q = 2 * q * chi.slope, chi_r = -2 * r * chi.slope;
  p.q = (2 * q * (1 + d) - b * chi_q) * part;
  p.r = (2 * r * (1 - d) - b * chi_r) * part;
  const double chi_qq = 4 * q * q * chi.bend + 2 * chi.slope;
  const double chi_rr = 4 * r * r * chi.bend - 2 * chi.slope;
  const double chi_qr = -4 * q * r * chi.bend;
  p.qq = (2 * (1 + d) + 4 * q * q - 2 * p.q * chi_q - b * chi_qq) * part;
  p.rr = (2 * (1 - d) + 4 * r * r - 2 * p.r * chi_r - b * chi_rr) * part;
  p.qr = (-4 * q * r - p.q * chi_r - p.r * chi_q - b * chi_qr) * part;
  return p;
}

/// n (1 + d^-2) - 4 with n = |J|^2 = 2 (Q^2 + R^2): at least 0, and 0 for rotations.
Profile dirichlet_profile(double q, double r) {
  const double d = (q - r) * (q + r), n = 2 * (q * q + r * r);
  const double k = 1 / (d * d), slope = -2 * k / d, bend = 6 * k * k;  // of d^-2
  const double k_q = slope * 2 * q, k_r = -slope * 2 * r;
  Profile p;
  p.value = n * (1 + k) - 4;
  p.q = 4 * q * (1 + k) + n * k_q;
  p.r = 4 * r * (1 + k) + n * k_r;
  p.qq = 4 * (1 + k) + 8 * q * k_q + n * (4 * q * q * bend + 2 * slope);
  p.rr = 4 * (1 + k) + 8 * r * k_r + n * (4 * r * r * bend - 2 * slope);
  p.qr = 4 * q * k_r + 4 * r * k_q - n * 4 * q * r * bend;
  return p;
}

void add(const Profile& part, double weight, Profile& sum) {
  sum.value += weight * part.value;
  sum.q += weight * part.q;
  sum.r += weight * part.r;
  sum.qq += weight * part.qq;
  sum.qr += weight * part.qr;
  sum.rr += weight * part.rr;
}

Profile profile(const Jacobian& j, double area, const Barrier& barrier) {
  const double q = j.turn_scale(), r = j.deformation();
  Profile p = fit_profile(q, r, barrier.rigidity.at(area));
  if (barrier.weight > 0) add(wall_profile(q, r, barrier.epsilon), barrier.weight, p);
  if (barrier.dirichlet > 0) add(dirichlet_profile(q, r), barrier.dirichlet, p);
  return p;
}

/// The nearest positive semidefinite block.
void project(Profile& p) {
  const double mean = (p.qq + p.rr) / 2, half = (p.qq - p.rr) / 2;
  const double radius = std::sqrt(half * half + p.qr * p.qr);
  if (mean - radius >= 0) return;
  const double high = std::max(0.0, mean + radius);  // along (radius + half, qr), unnormalised
  const double c = radius > 0 ? half / radius : 1, s = radius > 0 ? p.qr / radius : 0;
  p.qq = high * (1 + c) / 2;
  p.rr = high * (1 - c) / 2;
  p.qr = high * s / 2;
}

using Rows = Eigen::Matrix<double, 4, 6>;  // (e, h, f, g) by (u, v) of the three corners

Rows rows_of(const RestTriangle& rest) {
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

/// Gradient and projected Hessian of one triangle, by the coordinates of its corners.
struct Element {
  Eigen::Matrix<double, 6, 1> gradient;
  Eigen::Matrix<double, 6, 6> hessian;
};

Element element(const Jacobian& j, const RestTriangle& rest, const Barrier& barrier) {
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
  return {rest.area * rows.transpose() * slope, rest.area * rows.transpose() * bend * rows};
}

Jacobian jacobian_of(const BarrierMesh& mesh, std::size_t t, std::span<const Vec2> uv) {
  return jacobian(mesh.rest[t], uv_edges(mesh.faces[t], uv));
}

/// By the exact test; the determinant too, which the barrier divides by.
bool is_positive(const Jacobian& j, const Triangle& face, std::span<const Vec2> uv) {
  return (j.turn_scale() - j.deformation()) * j.sigma_max() > 0 && orientation(face, uv) > 0;
}

/// Where corner coordinate k (of 6) is among the unknowns; negative when the vertex is fixed.
Index unknown(const BarrierMesh& mesh, std::size_t t, Index k) {
  const Index slot =
      mesh.free.slot[static_cast<std::size_t>(mesh.faces[t][static_cast<std::size_t>(k / 2)])];
  return slot == kFixed ? kFixed : 2 * slot + k % 2;
}

/// The diagonal comes first in every column.
void add_springs(const BarrierMesh& mesh, std::span<const Vec2> uv, Quadratic& model) {
  for (const Spring& spring : mesh.springs) {
    const Index slot = mesh.free.slot[static_cast<std::size_t>(spring.vertex)];
    if (slot == kFixed) continue;
    const Vec2 away = uv[static_cast<std::size_t>(spring.vertex)] - spring.at;
    for (Index k = 0; k < 2; ++k) {
      model.gradient[2 * slot + k] += 2 * spring.weight * away[k];
      model.hessian.valuePtr()[model.hessian.outerIndexPtr()[2 * slot + k]] += 2 * spring.weight;
    }
  }
}

void add_lower(const Eigen::Matrix<double, 6, 6>& hessian, const std::array<Index, 21>& places,
               double* values) {
  const Index* place = places.data();
  for (Index a = 0; a < 6; ++a)
    for (Index b = 0; b <= a; ++b, ++place)
      if (*place != kFixed) values[*place] += hessian(a, b);
}

}  // namespace

double barrier_energy(const BarrierMesh& mesh, std::span<const Vec2> uv, const Barrier& barrier) {
  double energy = spring_energy(mesh.springs, uv);
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    look_now_and_then(t, mesh.stop);
    const Jacobian j = jacobian_of(mesh, t, uv);
    if (barrier.epsilon == 0 && !is_positive(j, mesh.faces[t], uv)) return kFar;
    energy += mesh.rest[t].area * profile(j, mesh.rest[t].area, barrier).value;
  }
  return energy;
}

double least_determinant(const BarrierMesh& mesh, std::span<const Vec2> uv) {
  double least = kFar;
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    look_now_and_then(t, mesh.stop);
    least = std::min(least, jacobian_of(mesh, t, uv).determinant());
  }
  return least;
}

Quadratic barrier_pattern(const BarrierMesh& mesh) {
  const Index size = 2 * mesh.free.count;
  Quadratic model{Eigen::VectorXd::Zero(size), pair_pattern(mesh.faces, mesh.free, mesh.stop), {}};
  model.place.resize(mesh.faces.size());
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    look_now_and_then(t, mesh.stop);
    std::size_t k = 0;
    for (Index a = 0; a < 6; ++a)
      for (Index b = 0; b <= a; ++b, ++k) {
        const auto [column, row] = std::minmax({unknown(mesh, t, a), unknown(mesh, t, b)});
        model.place[t][k] = column == kFixed ? kFixed : entry_of(model.hessian, row, column);
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
    look_now_and_then(t, mesh.stop);
    const Element e = element(jacobian_of(mesh, t, uv), mesh.rest[t], barrier);
    for (Index a = 0; a < 6; ++a) {
      const Index row = unknown(mesh, t, a);
      if (row != kFixed) model.gradient[row] += e.gradient[a];
    }
    add_lower(e.hessian, model.place[t], values);
  }
  add_springs(mesh, uv, model);
}

}  // namespace unwrapd
