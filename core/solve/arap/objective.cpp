#include "core/solve/arap/objective.hpp"

#include <cassert>
#include <utility>

#include "core/linear/sparse.hpp"
#include "core/solve/base/cached.hpp"

namespace unwrapd::solve::arap {
namespace {

using linear::at;

VertexConstraints constraints_by_rank(VertexConstraints constraints, std::span<const Index> rank) {
  for (HardConstraint& point : constraints.hard) point.vertex = rank[at(point.vertex)];
  for (SoftConstraint& soft_constraint : constraints.soft)
    soft_constraint.vertex = rank[at(soft_constraint.vertex)];
  return constraints;
}

FaceBlocks blocks_of(const CacheContext& by, const SharedList<measure::RestTriangle>& rest,
                     ListView<Triangle> faces, std::span<const Index> rank) {
  return face_blocks(rest, faces, rank, by.stop);
}

}  // namespace

Objective::Objective(const Disk& disk, const Rigidity& rigidity, VertexConstraints constraints,
                     std::span<const Index> rank, Executor& executor)
    : rigidity_(rigidity),
      holds_(constraints_by_rank(std::move(constraints), rank)),
      executor_(executor),
      blocks_(cached<blocks_of>(CacheContext{disk.core, disk.stop}, disk.rest, disk.faces, rank)),
      beyond_(blocks_->beyond.size()) {}

double Objective::pull_soft_constraints(std::span<const Vec2> uv, std::span<Vec2> force) const {
  double energy = 0;
  for (const SoftConstraint& soft_constraint : holds_.soft) {
    const std::size_t v = at(soft_constraint.vertex);
    const Vec2 away = uv[v] - soft_constraint.at;
    energy += soft_constraint.weight * away.squaredNorm();
    force[v] -= 2 * soft_constraint.weight * away;
  }
  return energy;
}

double Objective::evaluate(std::span<const Vec2> uv, std::span<Vec2> force) {
  const LocalSums fits = LocalStep{*blocks_, uv, rigidity_, force, beyond_}.run(executor_);
  uv_area_ = fits.uv_area;
  const double soft = pull_soft_constraints(uv, force);
  for (const HardConstraint& point : holds_.hard) force[at(point.vertex)].setZero();
  return fits.energy + soft;
}

}  // namespace unwrapd::solve::arap
