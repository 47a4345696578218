// Sawhney, Crane, "Boundary First Flattening", ACM TOG 37(1), 2017, with scale factors u = 0 given
// on the boundary (Sec. 4.3: least area distortion):
//   1. inside, L u = -K makes the metric flat (the linear Yamabe problem, Eq. 12);
//   2. the boundary then turns by k + (L u)_B at its vertices (the Cherrier formula, Eq. 13);
//   3. lengths and turns draw a curve that all but closes; lengths give way, Sec. 4.4;
//   4. the curve's coordinates are extended to a holomorphic function, Sec. 4.5.
// For step 4 one coordinate x is extended harmonically and the other is taken as its conjugate:
// which one, and along what axis, moves D_area by 8 % on Isis. The mean of the two extensions that
// x and y give is holomorphic too, prefers no axis, and has the lowest D_angle of all (2.050).
// Extending both coordinates harmonically would hit the curve but lose angles (2.056).
#include "core/solve/methods/bff.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "core/base/cancel.hpp"
#include "core/measure/energy.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/base/metric.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/maps/lay_out.hpp"

namespace unwrapd::solve::methods {
namespace {

/// Edges of the curve may shrink or grow by this share to close it. Beyond it, all points move.
constexpr double kMostStretch = 0.9;

/// The boundary as a closed chain of edges from vertex[i] to vertex[i + 1].
struct Chain {
  std::vector<std::size_t> vertex;
  std::vector<double> length;
};

Chain chain_of(const Disk& disk) {
  Chain chain;
  for (Index h : disk.loops.front()) {
    const auto a = static_cast<std::size_t>(start_of(disk.faces, h));
    const auto b = static_cast<std::size_t>(end_of(disk.faces, h));
    chain.vertex.push_back(a);
    chain.length.push_back((disk.positions[a] - disk.positions[b]).norm());
  }
  return chain;
}

/// Unit vectors along the edges of the chain, which turns by turn[v] at vertex v.
std::vector<Vec2> tangents(const Chain& chain, std::span<const double> turn) {
  std::vector<Vec2> tangent;
  double angle = 0;
  for (std::size_t v : chain.vertex) {
    if (!tangent.empty()) angle += turn[v];
    tangent.emplace_back(std::cos(angle), std::sin(angle));
  }
  return tangent;
}

/// The factors (1 - T_i . y) of the edge lengths that close the chain, with the least sum of (l' -
/// l)^2 / l. y solves (sum of l T T^t) y = sum of l T.
Vec2 closing(const Chain& chain, std::span<const Vec2> tangent) {
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Vec2 gap = Vec2::Zero();
  for (std::size_t i = 0; i < tangent.size(); ++i) {
    spread += chain.length[i] * tangent[i] * tangent[i].transpose();
    gap += chain.length[i] * tangent[i];
  }
  return Eigen::FullPivLU<Eigen::Matrix2d>(spread).solve(gap);
}

/// The closed curve, one point a vertex of the chain.
std::vector<Vec2> curve(const Chain& chain, std::span<const Vec2> tangent) {
  Vec2 y = closing(chain, tangent);
  if (!(y.norm() <= kMostStretch)) y.setZero();
  std::vector<Vec2> point;
  Vec2 end = Vec2::Zero();
  for (std::size_t i = 0; i < tangent.size(); ++i) {
    point.push_back(end);
    end += chain.length[i] * (1 - tangent[i].dot(y)) * tangent[i];
  }
  const double count = static_cast<double>(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) point[i] -= static_cast<double>(i) / count * end;
  return point;
}

/// The harmonic conjugates of the two coordinates of the curve: L y = -d x / d s on the boundary.
UvMap conjugates(const Disk& disk, const linear::SparseMatrix& laplacian, const Chain& chain,
                 std::span<const Vec2> point) {
  std::vector<char> fixed(disk.positions.size(), 0);
  fixed[chain.vertex.front()] = 1;  // conjugates are defined up to a constant
  const linear::FreeVertices free = linear::number_free(fixed);
  UvMap map(fixed.size(), Vec2::Zero());
  auto [lower, rhs] =
      linear::eliminate<linear::SparseMatrix, Vec2>(laplacian, free, map, disk.stop);
  const std::size_t count = point.size();
  for (std::size_t i = 1; i < count; ++i)
    rhs[static_cast<std::size_t>(free.slot[chain.vertex[i]])] +=
        (point[i - 1] - point[(i + 1) % count]) / 2;
  linear::factor(lower, disk.stop)->solve(rhs, disk.stop);
  for (std::size_t v = 0; v < map.size(); ++v)
    if (free.slot[v] != linear::kFixed) map[v] = rhs[static_cast<std::size_t>(free.slot[v])];
  return map;
}

/// The mean of the holomorphic x + i x* and -y* + i y, both zero in the mean over the boundary.
UvMap holomorphic(const Chain& chain, UvMap harmonic, const UvMap& conjugate) {
  Vec2 mean = Vec2::Zero();
  for (std::size_t v = 0; v < harmonic.size(); ++v)
    harmonic[v] += Vec2(-conjugate[v].y(), conjugate[v].x());
  for (std::size_t v : chain.vertex) mean += harmonic[v] / static_cast<double>(chain.vertex.size());
  for (Vec2& u : harmonic) u = (u - mean) / 2;
  return harmonic;
}

UvMap flatten(const Disk& disk, const SolveWatch& watch) {
  throw_if_cancelled(watch.loop.stop);
  if (watch.on_stage) watch.on_stage(Stage::factor);
  const linear::SparseMatrix laplacian = cotan_laplacian(disk, disk.rest);
  const InnerSystem inner(disk, laplacian);
  throw_if_cancelled(watch.loop.stop);
  if (watch.on_stage) watch.on_stage(Stage::solve);
  std::vector<double> turn = curvature(disk, disk.rest);
  const std::vector<double> change = product(laplacian, flat_scales(disk, inner, turn));
  for (std::size_t v = 0; v < turn.size(); ++v) turn[v] += change[v];
  const Chain chain = chain_of(disk);
  const std::vector<Vec2> point = curve(chain, tangents(chain, turn));
  UvMap map(disk.positions.size(), Vec2::Zero());
  for (std::size_t i = 0; i < point.size(); ++i) map[chain.vertex[i]] = point[i];
  inner.solve(map);
  throw_if_cancelled(watch.loop.stop);
  return holomorphic(chain, std::move(map), conjugates(disk, laplacian, chain, point));
}

}  // namespace

Solution bff(const Disk& disk, const SolveWatch& watch) {
  const maps::FilledDisk filled = maps::fill_holes(disk);
  Solution solution{
      .uv = flatten(filled.disk, watch), .energy = {}, .stop_reason = StopReason::direct};
  solution.uv.resize(disk.positions.size());
  maps::scale_to_area(disk, solution.uv);
  solution.energy.push_back(measure::asap_energy(disk.rest, disk.faces, solution.uv));
  return solution;
}

}  // namespace unwrapd::solve::methods
