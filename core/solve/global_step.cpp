// Eq. (4): sum_j [cot + cot](u_i - u_j) = sum_j [cot L + cot L](x_i - x_j) for every vertex i.
// The matrix is a sum of positive semidefinite element matrices whatever the cotangents' signs; its
// only null space is translation. Adding the diagonal entry of vertex 0 once more removes it and
// leaves the solution exact, because the right-hand side adds up to zero.
#include "core/solve/global_step.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace unwrapd {
namespace {

constexpr std::size_t kBlock = 4096;  // vertices a block

std::unique_ptr<RealSystem> factor_cotangent_matrix(const Disk& disk) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const RestTriangle& rest : disk.rest)
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  SparseMatrix lower = lower_laplacian(disk.faces, disk.vertex_count(), weight);
  lower.coeffRef(0, 0) *= 2;
  return factor(lower);
}

}  // namespace

GlobalStep::GlobalStep(const Disk& disk) : disk_(disk), system_(factor_cotangent_matrix(disk)) {}

void GlobalStep::advance(std::span<const Vec2> residual, std::span<Vec2> uv,
                         Executor& executor) const {
  const VertexCorners& corners = disk_.corners;
  const std::size_t n = uv.size();
  assert(corners.begin.size() == n + 1 && residual.size() == corners.corner.size());
  std::vector<Vec2> change(n);
  executor.for_each_block(static_cast<int>((n + kBlock - 1) / kBlock), [&](int block) {
    const std::size_t first = static_cast<std::size_t>(block) * kBlock;
    for (std::size_t v = first; v < std::min(n, first + kBlock); ++v) {
      Vec2 sum = Vec2::Zero();
      for (Index k = corners.begin[v]; k < corners.begin[v + 1]; ++k)
        sum += residual[static_cast<std::size_t>(corners.corner[static_cast<std::size_t>(k)])];
      change[v] = sum;
    }
  });
  system_->solve(change);
  for (std::size_t v = 0; v < n; ++v) uv[v] += change[v];
}

}  // namespace unwrapd
