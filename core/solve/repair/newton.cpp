// A step ends before the first triangle collapses on its way (the step rule of Smith and Schaefer,
// "Bijective Parameterization with Free Boundaries", SIGGRAPH 2015), then is halved until the
// energy falls as the gradient promises (Armijo). A full step that does is doubled while the energy
// falls on: a projected Hessian is too stiff where a flap turns over, and steps come out too short.
// Quasi-Newton with the mesh's Laplacian would need no factor for each step, but stalls where
// slivers meet barriers.
#include "core/solve/repair/newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/shared_cache.hpp"
#include "core/mesh/cross.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kArmijo = 1e-4;
constexpr int kMostHalvings = 40;
constexpr double kOfTheWayToCollapse = 0.9;
constexpr double kLeastShift = 1e-10;  // added to the diagonal, of its mean
constexpr double kMostShift = 1e2;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// The least t > 0 at which a + b t + c t^2 is zero, for a > 0; infinity when there is none.
double first_root(double a, double b, double c) {
  const double inside = b * b - 4 * a * c;
  if (inside < 0) return INFINITY;
  const double near = -b + std::copysign(std::sqrt(inside), -b);  // the root without cancellation
  const double one = near == 0 ? INFINITY : 2 * a / near;
  const double other = c == 0 ? INFINITY : near / (2 * c);
  const double least = std::min(one > 0 ? one : INFINITY, other > 0 ? other : INFINITY);
  return least;
}

/// The step length at which the first triangle has no area left.
double collapse_length(const BarrierMesh& mesh, const UvMap& uv, const UvMap& move) {
  double length = INFINITY;
  for (const Triangle& face : mesh.faces) {
    const measure::UvEdges u = measure::uv_edges(face, uv), d = measure::uv_edges(face, move);
    length = std::min(length, first_root(cross(u[0], u[1]), cross(u[0], d[1]) + cross(d[0], u[1]),
                                         cross(d[0], d[1])));
  }
  return length;
}

/// x: one entry an unknown, in its first coordinate.
UvMap scatter(const linear::FreeVertices& free, std::span<const Vec2> x) {
  UvMap move(free.slot.size(), Vec2::Zero());
  for (std::size_t v = 0; v < move.size(); ++v)
    if (free.slot[v] != linear::kFixed)
      move[v] = Vec2(x[at(2 * free.slot[v])].x(), x[at(2 * free.slot[v] + 1)].x());
  return move;
}

UvMap move_along(const UvMap& uv, const UvMap& move, double length) {
  UvMap to(uv.size());
  for (std::size_t v = 0; v < uv.size(); ++v) to[v] = uv[v] + length * move[v];
  return to;
}

/// A map some way along a step.
struct Trial {
  double length;
  UvMap uv;
  double energy;
};

}  // namespace

bool Newton::factor(Executor& job) {
  linear::SparseMatrix& hessian = model_.hessian;
  if (!factor_) {
    auto analysis = linear::analyse_pairs(hessian, mesh_.stop);
    unwrapd::check_memory(mesh_.memory.taken + analysis->job_bytes() + model_.bytes(),
                          mesh_.memory.limit);
    factor_.emplace(std::move(analysis));
  }
  const double mean = hessian.diagonal().sum() / static_cast<double>(hessian.rows());
  double added = 0;
  for (double shift = kLeastShift; shift <= kMostShift; shift *= 1e3) {
    for (Index k = 0; k < hessian.rows(); ++k)
      hessian.valuePtr()[hessian.outerIndexPtr()[k]] += shift * mean - added;
    added = shift * mean;
    if (factor_->refill(hessian, job)) return true;
  }
  return false;
}

double Newton::step(UvMap& uv, const Barrier& barrier) {
  fill_barrier_model(mesh_, uv, barrier, model_);
  SerialExecutor serial;
  JobExecutor job(executor_ != nullptr ? *executor_ : serial, mesh_.stop);
  if (!factor(job)) return 0;
  std::vector<Vec2> x(static_cast<std::size_t>(model_.gradient.size()), Vec2::Zero());
  for (std::size_t k = 0; k < x.size(); ++k) x[k].x() = -model_.gradient[static_cast<Index>(k)];
  factor_->solve(x, job);
  double slope = 0;
  for (std::size_t k = 0; k < x.size(); ++k)
    slope += model_.gradient[static_cast<Index>(k)] * x[k].x();
  if (!(slope < 0)) return 0;
  return search(scatter(mesh_.free, x), slope, barrier, uv);
}

double Newton::search(const UvMap& move, double slope, const Barrier& barrier, UvMap& uv) const {
  const double before = barrier_energy(mesh_, uv, barrier);
  const double most =
      barrier.epsilon == 0 ? kOfTheWayToCollapse * collapse_length(mesh_, uv, move) : 1;
  const auto at_length = [&](double length) {
    Trial trial{length, move_along(uv, move, length), 0};
    trial.energy = barrier_energy(mesh_, trial.uv, barrier);
    return trial;
  };
  Trial best = at_length(std::min(1.0, most));
  for (int k = 0; !(best.energy <= before + kArmijo * best.length * slope); ++k) {
    if (k == kMostHalvings) return 0;
    best = at_length(best.length / 2);
  }
  while (best.length >= 1 && best.length < most) {
    Trial farther = at_length(std::min(2 * best.length, most));
    if (!(farther.energy < best.energy)) break;
    best = std::move(farther);
  }
  uv = std::move(best.uv);
  return (before - best.energy) / std::abs(before);
}

}  // namespace unwrapd::solve::repair
