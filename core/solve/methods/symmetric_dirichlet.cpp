// With Q, R of core/measure/jacobian.hpp: |J|^2 = 2 (Q^2 + R^2) and |J^-1|^2 = |J|^2 / det^2. The
// proxy's weight is W^2 = U diag(m1, m2) U' with m = (s - s^-3) / (s - 1), written without the
// division that vanishes at s = 1; U' comes from products of J's parts, without an angle.
#include "core/solve/methods/symmetric_dirichlet.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/measure/orientation.hpp"

namespace unwrapd::solve::methods {
namespace {

constexpr std::size_t kFacesOfBlock =
    4096;  // faces or vertices a block; fixed, so that sums do not depend on threads
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Body>
void for_blocks(std::size_t count, Executor& executor, Body body) {
  executor.for_each_block(
      static_cast<int>((count + kFacesOfBlock - 1) / kFacesOfBlock), [&](int block) {
        const std::size_t first = static_cast<std::size_t>(block) * kFacesOfBlock;
        body(static_cast<std::size_t>(block), first, std::min(count, first + kFacesOfBlock));
      });
}

std::size_t block_count(std::size_t count) { return (count + kFacesOfBlock - 1) / kFacesOfBlock; }

double norm2(const measure::Jacobian& j) {
  return 2 * (j.e * j.e + j.h * j.h + j.f * j.f + j.g * j.g);
}

/// The gradient of the hat function of corner i.
Vec2 hat_gradient(const measure::RestTriangle& rest, std::size_t i) {
  const Vec2& opposite = rest.edge[(i + 1) % 3];
  return Vec2(opposite.y(), -opposite.x()) / (2 * rest.area);
}

/// dE/dJ = p J + q cof(J): the similarity part of cof(J) is that of J, the rest has the other sign.
measure::Jacobian energy_slope(const measure::Jacobian& j) {
  const double det = j.determinant();
  const double p = 2 + 2 / (det * det);
  const double q = -2 * norm2(j) / (det * det * det);
  return {(p + q) * j.e, (p + q) * j.h, (p - q) * j.f, (p - q) * j.g};
}

double proxy_weight(double s) { return (s + 1) * (s * s + 1) / (s * s * s); }

/// The least positive root of c + b t + a t^2, c > 0.
double least_root(double a, double b, double c) {
  const double under = b * b - 4 * a * c;
  if (under < 0) return kInfinity;
  const double q = -(b + std::copysign(std::sqrt(under), b)) / 2;
  double least = kInfinity;
  for (double root : {q / a, c / q})
    if (root > 0) least = std::min(least, root);
  return least;
}

double face_step_to_flip(const measure::Jacobian& j, const measure::Jacobian& d) {
  const double across = 2 * (j.e * d.e + j.h * d.h - j.f * d.f - j.g * d.g);
  return least_root(d.determinant(), across, j.determinant());
}

}  // namespace

double symmetric_dirichlet(const measure::Jacobian& j) {
  const double det = j.determinant();
  return det > 0 ? norm2(j) * (1 + 1 / (det * det)) : kInfinity;
}

double symmetric_dirichlet_energy(const Disk& disk, std::span<const Vec2> uv, Executor& executor) {
  std::vector<double> sum(block_count(disk.faces.size()), 0.0);
  for_blocks(disk.faces.size(), executor, [&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end && sum[b] < kInfinity; ++t) {
      const measure::Jacobian j =
          measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
      const bool is_upright = measure::orientation(disk.faces[t], uv) > 0;
      const double density = is_upright ? symmetric_dirichlet(j) : kInfinity;
      sum[b] += disk.rest[t].area * density;
    }
  });
  double total = 0;
  for (double x : sum) total += x;
  return total;
}

void symmetric_dirichlet_gradient(const Disk& disk, std::span<const Vec2> uv,
                                  std::span<Vec2> gradient, Executor& executor) {
  std::vector<Vec2> pull(3 * disk.faces.size());
  for_blocks(disk.faces.size(), executor, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const measure::RestTriangle& rest = disk.rest[t];
      const measure::Jacobian slope =
          energy_slope(measure::jacobian(rest, measure::uv_edges(disk.faces[t], uv)));
      for (std::size_t i = 0; i < 3; ++i)
        pull[3 * t + i] = rest.area * measure::apply(slope, hat_gradient(rest, i));
    }
  });
  const linear::VertexCorners& corners = disk.corners;
  for_blocks(gradient.size(), executor, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      gradient[v].setZero();
      for (Index k = corners.begin[v]; k < corners.begin[v + 1]; ++k)
        gradient[v] += pull[static_cast<std::size_t>(corners.corner[static_cast<std::size_t>(k)])];
    }
  });
}

double best_scale(const Disk& disk, std::span<const Vec2> uv) {
  double growth = 0, shrinkage = 0;
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    const measure::Jacobian j =
        measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
    const double det = j.determinant();
    growth += disk.rest[t].area * norm2(j);
    shrinkage += disk.rest[t].area * norm2(j) / (det * det);
  }
  return std::sqrt(std::sqrt(shrinkage / growth));
}

linear::PairElement proxy_element(const measure::RestTriangle& rest, const measure::Jacobian& j) {
  const double m1 = proxy_weight(j.sigma_max());
  const double m2 = proxy_weight(j.determinant() / j.sigma_max());
  const double qr = j.turn_scale() * j.deformation();
  const double mean = (m1 + m2) / 2;
  const double tilt = qr > 0 ? (m1 - m2) / (2 * qr) : 0;
  const double c = tilt * (j.e * j.f - j.h * j.g), s = tilt * (j.h * j.f + j.e * j.g);
  const std::array<std::array<double, 2>, 2> weight{{{mean + c, s}, {s, mean - c}}};
  linear::PairElement element{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k <= i; ++k)
      element[i][k] = 2 * rest.area * weight[i % 2][k % 2] *
                      hat_gradient(rest, i / 2).dot(hat_gradient(rest, k / 2));
  return element;
}

double step_to_flip(const Disk& disk, std::span<const Vec2> uv, std::span<const Vec2> step,
                    Executor& executor) {
  std::vector<double> least(block_count(disk.faces.size()), kInfinity);
  for_blocks(disk.faces.size(), executor, [&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const measure::Jacobian j =
          measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], uv));
      const measure::Jacobian d =
          measure::jacobian(disk.rest[t], measure::uv_edges(disk.faces[t], step));
      least[b] = std::min(least[b], face_step_to_flip(j, d));
    }
  });
  return *std::min_element(least.begin(), least.end());
}

}  // namespace unwrapd::solve::methods
