#include "core/solve/arap/objective.hpp"

#include <cassert>
#include <utility>

#include "core/solve/base/kept.hpp"

namespace unwrapd {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Holds renumbered(Holds holds, std::span<const Index> rank) {
  for (FixedPoint& point : holds.fixed) point.vertex = rank[at(point.vertex)];
  for (Spring& spring : holds.springs) spring.vertex = rank[at(spring.vertex)];
  return holds;
}

FaceBlocks blocks_of(const Making& by, const SharedList<RestTriangle>& rest,
                     ListView<Triangle> faces, std::span<const Index> rank) {
  return face_blocks(rest, faces, rank, by.stop);
}

}  // namespace

Objective::Objective(const Disk& disk, const Rigidity& rigidity, Holds holds,
                     std::span<const Index> rank, Executor& executor)
    : rigidity_(rigidity),
      holds_(renumbered(std::move(holds), rank)),
      executor_(executor),
      blocks_(kept<blocks_of>(Making{disk.core, disk.stop}, disk.rest, disk.faces, rank)),
      beyond_(blocks_->beyond.size()) {}

double Objective::pull_springs(std::span<const Vec2> uv, std::span<Vec2> force) const {
  double energy = 0;
  for (const Spring& spring : holds_.springs) {
    const std::size_t v = at(spring.vertex);
    const Vec2 away = uv[v] - spring.at;
    energy += spring.weight * away.squaredNorm();
    force[v] -= 2 * spring.weight * away;
  }
  return energy;
}

double Objective::evaluate(std::span<const Vec2> uv, std::span<Vec2> force) {
  const LocalSums fits = LocalStep{*blocks_, uv, rigidity_, force, beyond_}.run(executor_);
  uv_area_ = fits.uv_area;
  const double springs = pull_springs(uv, force);
  for (const FixedPoint& point : holds_.fixed) force[at(point.vertex)].setZero();
  return fits.energy + springs;
}

}  // namespace unwrapd
