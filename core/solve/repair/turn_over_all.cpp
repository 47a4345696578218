// The alternating direction method of multipliers (Boyd, Parikh, Chu, Peleato, Eckstein 2011, Sec.
// 3; with rotations: Overby, Brown, Li, Narain 2017). Each triangle has a Jacobian Y_t of its own
// that is never flipped, and each soft constraint a point y_v; the map u follows them:
//   minimise sum A_t [ |Y_t - s R_t|^2 + mu SD(Y_t) ] + sum w |y_v - at|^2
//   subject to Y_t = J_t(u), y_v = u_v.
// Y_t is found triangle by triangle: with the turns of J_t + U_t kept the sum falls apart into one
// equation for each singular value. u is found by one solve, whose matrix is that of the method's
// own iterations whatever is flipped. U_t adds up how much the two differ. It starts so that a map
// at rest under the method's energy alone stays where nothing is flipped.
//
// Where a triangle collapses, the energy of its turn is not convex; with a penalty of 8 instead of
// 15 times the energy's own curvature some maps swing, and flips come back. Over-relaxation leaves
// flips, too. A Newton step on the whole takes the time of twenty of these, and ten times the
// memory.
#include "core/solve/repair/turn_over_all.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/cancel.hpp"
#include "core/solve/repair/sizes.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kPenalty = 15;      // rho
constexpr double kDirichlet = 1e-3;  // mu: that of the last maps of settle()
constexpr double kAtRest = 1e-3;     // root mean square change of the Jacobians in a step
constexpr int kUsualSteps = 30;      // after these, a map near rest is accepted
constexpr double kNearRest = 1e-2;
constexpr double kLeastTurn = 0.5;  // of a similarity part, to keep its direction at the start
constexpr double kSlope = 1 + kDirichlet + kPenalty;
constexpr int kMostRootSteps = 8;        // 1 to 3 are taken
constexpr double kRootTolerance = 1e-3;  // of a step: its square is what is left

measure::Jacobian sum(const measure::Jacobian& a, double w, const measure::Jacobian& b) {
  return {a.e + w * b.e, a.h + w * b.h, a.f + w * b.f, a.g + w * b.g};
}

/// The similarity part and the remainder of j, each multiplied by a factor.
measure::Jacobian scale_parts(const measure::Jacobian& j, double similarity, double rest) {
  return {similarity * j.e, similarity * j.h, rest * j.f, rest * j.g};
}

/// Below the root of kSlope x = b + mu x^-3.
double below_the_root(double b) {
  static const double least = std::sqrt(std::sqrt(kDirichlet / (2 * kSlope)));
  return b < 0 ? std::min(least, std::cbrt(-kDirichlet / (2 * b))) : std::max(least, b / kSlope);
}

/// The singular values of Y, where J + U has z and the fit has s: the positive roots x of
/// (1 + mu + rho) x = s + rho z + mu x^-3, all in units of the size that the triangle shall have.
/// The left side less the right one rises and is concave: from below, Newton climbs to the root.
Eigen::Array2d singular_values(const Eigen::Array2d& z, double s) {
  const Eigen::Array2d b = s + kPenalty * z;
  Eigen::Array2d x(below_the_root(b[0]), below_the_root(b[1]));
  for (int k = 0; k < kMostRootSteps; ++k) {
    const Eigen::Array2d inverse = 1 / x, wall = kDirichlet * inverse * inverse * inverse;
    const Eigen::Array2d step = (b + wall - kSlope * x) / (kSlope + 3 * wall * inverse);
    x += step;
    if ((step <= kRootTolerance * x).all()) break;
  }
  return x;
}

VertexConstraints constraints_of(const MapIntent& intent, std::span<const Vec2> uv) {
  VertexConstraints constraints{{}, intent.soft};
  for (std::size_t v = 0; v < intent.constrained.size(); ++v)
    if (intent.constrained[v] != 0) constraints.hard.push_back({static_cast<Index>(v), uv[v]});
  return constraints;
}

/// The Jacobians and multipliers of the iteration.
class Splitting {
 public:
  Splitting(const Disk& disk, const MapIntent& intent, Executor& executor, std::span<const Vec2> uv)
      : disk_(disk),
        intent_(intent),
        executor_(executor),
        excess_(disk.faces.size()),
        pull_(3 * disk.faces.size()),
        force_(uv.size()) {
    if (intent.global == nullptr) own_.emplace(disk, constraints_of(intent, uv), &executor);
    if (intent.rigidity.lambda < kConformalBelow) size_ = sizes_around(disk.faces, disk.rest, uv);
    for_faces([&](std::size_t t) { excess_[t] = excess_at_rest(t, uv); });
    for (const SoftConstraint& soft_constraint : intent.soft)
      soft_excess_.emplace_back((uv[soft_constraint.vertex] - soft_constraint.at) / kPenalty);
  }

  /// Returns the root mean square change of the Jacobians, on a disk of area 1.
  double step(UvMap& uv) {
    for_faces([&](std::size_t t) { pull(t, uv); });
    add_up();
    pull_soft_constraints(uv);
    change_ = force_;
    global().solve(change_);
    double square = 0;
    for (std::size_t v = 0; v < uv.size(); ++v) {
      square += change_[v].dot(force_[v]) / 2;
      uv[v] += change_[v];
    }
    return std::sqrt(std::max(0.0, square));
  }

 private:
  [[nodiscard]] const arap::GlobalStep& global() const { return own_ ? *own_ : *intent_.global; }

  template <class Body>
  void for_faces(Body body) {
    for_each_part(excess_.size(), executor_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) body(t);
    });
  }

  /// The scale of the similarity that best fits a Jacobian with |similarity part| q.
  [[nodiscard]] double fitted_scale(std::size_t t, double q) const {
    return arap::hybrid_scale(intent_.rigidity.at(disk_.rest[t].area), q);
  }

  /// rho U = Y - s R where Y is J.
  [[nodiscard]] measure::Jacobian excess_at_rest(std::size_t t, std::span<const Vec2> uv) const {
    const measure::Jacobian j =
        measure::jacobian(disk_.rest[t], measure::uv_edges(disk_.faces[t], uv));
    const double q = j.turn_scale();
    const double misfit = q > 0 ? 1 - fitted_scale(t, q) / q : 0;
    return scale_parts(j, std::max(misfit / kPenalty, -kLeastTurn), 1 / kPenalty);
  }

  /// Y for z = J + U and a fit of this scale.
  [[nodiscard]] measure::Jacobian upright(std::size_t t, const measure::Jacobian& z,
                                          double scale) const {
    const double size = size_.empty() ? 1 : size_[t];
    const double q = z.turn_scale(), r = z.deformation();
    const Eigen::Array2d value =
        size * singular_values({(q + r) / size, (q - r) / size}, scale / size);
    const double high = value[0], low = value[1];
    if (!(q > 0)) return {(high + low) / 2, 0, z.f, z.g};  // all rotations fit equally
    return scale_parts(z, (high + low) / (2 * q), r > 0 ? (high - low) / (2 * r) : 0);
  }

  /// The new Y and U of a face, and the forces on its corners towards Y - U.
  void pull(std::size_t t, std::span<const Vec2> uv) {
    const measure::RestTriangle& rest = disk_.rest[t];
    const measure::UvEdges edges = measure::uv_edges(disk_.faces[t], uv);
    const measure::Jacobian j = measure::jacobian(rest, edges), z = sum(j, 1, excess_[t]);
    const measure::Jacobian y = upright(t, z, fitted_scale(t, j.turn_scale()));
    excess_[t] = sum(z, -1, y);
    const measure::Jacobian target = sum(y, -1, excess_[t]);
    std::array<Vec2, 3> along;
    for (std::size_t i = 0; i < 3; ++i)
      along[i] = rest.cot[i] * (measure::apply(target, rest.edge[i]) - edges[i]);
    for (std::size_t i = 0; i < 3; ++i) pull_[3 * t + i] = along[i] - along[(i + 2) % 3];
  }

  void add_up() {
    const linear::VertexCorners& corners = disk_.corners;
    for_each_part(force_.size(), executor_, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        force_[v].setZero();
        for (Index k = corners.begin[v]; k < corners.begin[v + 1]; ++k)
          force_[v] += pull_[static_cast<std::size_t>(corners.corner[k])];
      }
    });
  }

  void pull_soft_constraints(std::span<const Vec2> uv) {
    for (std::size_t k = 0; k < soft_excess_.size(); ++k) {
      const SoftConstraint& soft_constraint = intent_.soft[k];
      const Vec2 z = uv[soft_constraint.vertex] + soft_excess_[k];
      const Vec2 y = (soft_constraint.at + kPenalty * z) / (1 + kPenalty);
      soft_excess_[k] = z - y;
      force_[soft_constraint.vertex] +=
          2 * soft_constraint.weight * (2 * y - z - uv[soft_constraint.vertex]);
    }
  }

  const Disk& disk_;
  const MapIntent& intent_;
  Executor& executor_;
  std::optional<arap::GlobalStep> own_;
  std::vector<double> size_;               // empty: the sizes of the surface
  std::vector<measure::Jacobian> excess_;  // U
  std::vector<Vec2> soft_excess_;
  std::vector<Vec2> pull_;  // on each corner
  std::vector<Vec2> force_, change_;
};

}  // namespace

int turn_over_all(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  SerialExecutor serial;
  JobExecutor job(intent.executor != nullptr ? *intent.executor : serial, intent.stop);
  Splitting splitting(disk, intent, job, uv);
  for (int k = 1; k <= kMostSplitSteps; ++k) {
    const double change = splitting.step(uv);
    if (change < (k < kUsualSteps ? kAtRest : kNearRest)) return k;
  }
  return kMostSplitSteps;
}

}  // namespace unwrapd::solve::repair
