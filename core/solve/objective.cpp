#include "core/solve/objective.hpp"

#include <algorithm>
#include <cassert>

namespace unwrapd {
namespace {

constexpr std::size_t kBlock = 4096;  // vertices a block

/// force[v]: the sum of the residual over the corners of v.
void gather(const VertexCorners& corners, std::span<const Vec2> residual, std::span<Vec2> force,
            Executor& executor) {
  const std::size_t n = force.size();
  executor.for_each_block(static_cast<int>((n + kBlock - 1) / kBlock), [&](int block) {
    const std::size_t first = static_cast<std::size_t>(block) * kBlock;
    for (std::size_t v = first; v < std::min(n, first + kBlock); ++v) {
      Vec2 sum = Vec2::Zero();
      for (Index k = corners.begin[v]; k < corners.begin[v + 1]; ++k)
        sum += residual[static_cast<std::size_t>(corners.corner[static_cast<std::size_t>(k)])];
      force[v] = sum;
    }
  });
}

}  // namespace

Objective::Objective(const Disk& disk, const Rigidity& rigidity, const Holds& holds,
                     Executor& executor)
    : disk_(disk),
      rigidity_(rigidity),
      holds_(holds),
      executor_(executor),
      groups_(face_groups(disk.rest, disk.faces)),
      residual_(3 * kFacesAbreast * groups_.size()) {}

double Objective::pull_springs(std::span<const Vec2> uv, std::span<Vec2> force) const {
  double energy = 0;
  for (const Spring& spring : holds_.springs) {
    const auto v = static_cast<std::size_t>(spring.vertex);
    const Vec2 away = uv[v] - spring.at;
    energy += spring.weight * away.squaredNorm();
    force[v] -= 2 * spring.weight * away;
  }
  return energy;
}

double Objective::evaluate(std::span<const Vec2> uv, std::span<Vec2> force) {
  assert(uv.size() == disk_.positions.size() && force.size() == uv.size());
  const LocalSums fits = local_step(groups_, uv, rigidity_, residual_, executor_);
  uv_area_ = fits.uv_area;
  gather(disk_.corners, residual_, force, executor_);
  const double springs = pull_springs(uv, force);
  for (const FixedPoint& point : holds_.fixed)
    force[static_cast<std::size_t>(point.vertex)].setZero();
  return fits.energy + springs;
}

}  // namespace unwrapd
