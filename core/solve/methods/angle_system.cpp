#include "core/solve/methods/angle_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/solve/base/cached.hpp"
#include "core/solve/maps/lay_out.hpp"

namespace unwrapd::solve::methods {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kLeastGap = 0.1;  // share of an angle's distance from pi that scaling must leave
constexpr std::size_t kBlock = 2048;  // faces a block

Index start_vertex(const Disk& disk, Index h) {
  return disk.faces[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(h % 3)];
}

double dot(const FaceAngles& x, const FaceAngles& y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/// Calls body(ring, i) for every corner i that lies on a ring.
template <class Body>
void for_ring_corners(const Triangle& face, const Rings& rings, Body body) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Index slot = rings.of.slot[static_cast<std::size_t>(face[i])];
    if (slot != linear::kFixed) body(static_cast<std::size_t>(slot), i);
  }
}

}  // namespace

std::vector<FaceAngles> mesh_angles(const Disk& disk) {
  std::vector<FaceAngles> angles(disk.rest.size());
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) angles[t][i] = std::atan2(1, disk.rest[t].cot[(i + 1) % 3]);
  return angles;
}

std::vector<FaceAngles> target_angles(const Disk& disk) {
  std::vector<FaceAngles> angles = mesh_angles(disk);
  std::vector<double> sum(disk.positions.size(), 0.0);
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      sum[static_cast<std::size_t>(disk.faces[t][i])] += angles[t][i];
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) sum[static_cast<std::size_t>(start_vertex(disk, h))] = 2 * kHalfTurn;
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const double scaled =
          angles[t][i] * 2 * kHalfTurn / sum[static_cast<std::size_t>(disk.faces[t][i])];
      angles[t][i] = std::min(scaled, kHalfTurn - kLeastGap * (kHalfTurn - angles[t][i]));
    }
  return angles;
}

Rings make_rings(const Disk& disk) {
  std::vector<char> on_boundary(disk.positions.size(), 0);
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) on_boundary[static_cast<std::size_t>(start_vertex(disk, h))] = 1;
  Rings rings{linear::number_free(on_boundary), {}};
  rings.turn.assign(static_cast<std::size_t>(rings.of.count), 2 * kHalfTurn);
  for (std::size_t hole = 1; hole < disk.loops.size(); ++hole) {
    for (Index h : disk.loops[hole])
      rings.of.slot[static_cast<std::size_t>(start_vertex(disk, h))] = rings.of.count;
    rings.turn.push_back(static_cast<double>(disk.loops[hole].size() + 2) * kHalfTurn);
    ++rings.of.count;
  }
  return rings;
}

double Misfit::largest() const {
  double most = 0;
  for (double x : triangle) most = std::max(most, std::abs(x));
  for (const Vec2& x : ring) most = std::max({most, std::abs(x[0]), std::abs(x[1])});
  return most;
}

/// The contribution of a face to the reduced system: B_t, whose row 2i + c is the gradient of
/// constraint c (planarity, wheel) of corner i's ring; P_t; and the change that the face alone
/// would make.
struct AngleSystem::FaceBlock {
  std::array<FaceAngles, 6> gradient{};
  std::array<FaceAngles, 3> projection{};
  FaceAngles change{};

  /// Sets the block for these angles and the model of this face.
  void set(const FaceAngles& angle, const FaceAngles& slope, const FaceAngles& curvature);

  /// B P B'
  [[nodiscard]] linear::PairElement element() const;
};

/// P = 1/D - (1/D) 1 1' (1/D) / (1' (1/D) 1), in a form without cancellation.
void AngleSystem::FaceBlock::set(const FaceAngles& angle, const FaceAngles& slope,
                                 const FaceAngles& curvature) {
  const FaceAngles give{1 / curvature[0], 1 / curvature[1], 1 / curvature[2]};
  const double total = give[0] + give[1] + give[2];
  const double excess = angle[0] + angle[1] + angle[2] - kHalfTurn;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    projection[i][i] = give[i] * (give[j] + give[k]) / total;
    projection[i][j] = projection[j][i] = -give[i] * give[j] / total;
    gradient[2 * i][i] = 1;
    gradient[2 * i + 1][j] = 1 / std::tan(angle[j]);
    gradient[2 * i + 1][k] = -1 / std::tan(angle[k]);
  }
  for (std::size_t i = 0; i < 3; ++i)
    change[i] = -excess * give[i] / total - dot(projection[i], slope);
}

linear::PairElement AngleSystem::FaceBlock::element() const {
  linear::PairElement element{};
  for (std::size_t i = 0; i < 6; ++i) {
    FaceAngles pushed{};
    for (std::size_t j = 0; j < 3; ++j) pushed[j] = dot(gradient[i], projection[j]);
    for (std::size_t j = 0; j <= i; ++j) element[i][j] = dot(pushed, gradient[j]);
  }
  return element;
}

AngleSystem::AngleSystem(const Disk& disk, Executor& executor)
    : disk_(disk), executor_(executor), rings_(make_rings(disk)) {
  if (rings_.of.count > 0)
    check_memory(disk, system_.emplace(disk.faces, rings_.of, disk.stop).bytes());
  multipliers_.assign(static_cast<std::size_t>(rings_.of.count), Vec2::Zero());
}

Misfit AngleSystem::misfit(std::span<const FaceAngles> angles) const {
  Misfit misfit{std::vector<double>(angles.size()), std::vector<Vec2>(rings_.turn.size())};
  for (std::size_t r = 0; r < misfit.ring.size(); ++r) misfit.ring[r] = Vec2(-rings_.turn[r], 0);
  for (std::size_t t = 0; t < angles.size(); ++t) {
    check_cancelled_every(t, disk_.stop);
    const FaceAngles& a = angles[t];
    misfit.triangle[t] = a[0] + a[1] + a[2] - kHalfTurn;
    for_ring_corners(disk_.faces[t], rings_, [&](std::size_t v, std::size_t i) {
      misfit.ring[v] += Vec2(a[i], std::log(std::sin(a[(i + 1) % 3]) / std::sin(a[(i + 2) % 3])));
    });
  }
  return misfit;
}

std::vector<AngleSystem::FaceBlock> AngleSystem::blocks(std::span<const FaceAngles> angles,
                                                        const AngleModel& model) const {
  std::vector<FaceBlock> blocks(angles.size());
  const std::size_t count = (angles.size() + kBlock - 1) / kBlock;
  executor_.for_each_block(static_cast<int>(count), [&](int block) {
    const std::size_t first = static_cast<std::size_t>(block) * kBlock;
    for (std::size_t t = first; t < std::min(angles.size(), first + kBlock); ++t)
      blocks[t].set(angles[t], model.slope[t], model.curvature[t]);
  });
  return blocks;
}

void AngleSystem::factor(std::span<const FaceBlock> blocks) {
  system_->clear();
  for (std::size_t t = 0; t < blocks.size(); ++t) system_->add(t, blocks[t].element());
  if (!system_->factor())
    throw Error(ErrorCode::solver_failed,
                "no flat angles were found for this mesh; choose method asap or arap");
}

std::vector<FaceAngles> AngleSystem::step(std::span<const FaceAngles> angles,
                                          const AngleModel& model) {
  const std::vector<FaceBlock> block = blocks(angles, model);
  Misfit left = misfit(angles);
  for (std::size_t t = 0; t < angles.size(); ++t) {
    check_cancelled_every(t, disk_.stop);
    for_ring_corners(disk_.faces[t], rings_, [&](std::size_t v, std::size_t i) {
      left.ring[v] += Vec2(dot(block[t].gradient[2 * i], block[t].change),
                           dot(block[t].gradient[2 * i + 1], block[t].change));
    });
  }
  multipliers_ = std::move(left.ring);
  if (system_) {
    factor(block);
    system_->solve(multipliers_);
  }
  std::vector<FaceAngles> change(angles.size());
  for (std::size_t t = 0; t < angles.size(); ++t) {
    check_cancelled_every(t, disk_.stop);
    FaceAngles pull{};
    for_ring_corners(disk_.faces[t], rings_, [&](std::size_t v, std::size_t i) {
      for (std::size_t j = 0; j < 3; ++j)
        pull[j] += multipliers_[v][0] * block[t].gradient[2 * i][j] +
                   multipliers_[v][1] * block[t].gradient[2 * i + 1][j];
    });
    for (std::size_t j = 0; j < 3; ++j)
      change[t][j] = block[t].change[j] - dot(block[t].projection[j], pull);
  }
  return change;
}

double angle_energy(const AngleSystem& system, std::span<const FaceAngles> angles,
                    std::span<const FaceAngles> target) {
  double sum = 0;
  for (std::size_t t = 0; t < angles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = angles[t][i] / target[t][i] - 1;
      sum += error * error;
    }
  return sum / static_cast<double>(3 * angles.size()) + system.misfit(angles).largest();
}

UvMap map_of_angles(const Disk& disk, std::span<const FaceAngles> angles) {
  std::vector<measure::RestTriangle> flat(angles.size());
  std::transform(angles.begin(), angles.end(), flat.begin(), maps::triangle_of_angles);
  return maps::lay_out(disk, std::move(flat));
}

}  // namespace unwrapd::solve::methods
