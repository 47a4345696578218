// Karni, Gotsman, Gortler, "Free-Boundary Linear Parameterization of 3D Meshes in the Presence of
// Constraints", SMI 2005: the boundary is padded with a ring of virtual triangles whose outer rim
// is convex, so that the true boundary may lie as it likes, and every vertex becomes a convex
// combination of its neighbours. By Tutte's theorem nothing is flipped, whatever the weights.
//
// The weights are those that keep a vertex where it is: of all positive ones that do, those of
// greatest entropy (Hormann and Sukumar 2008), which exist wherever a vertex lies inside the hull
// of its neighbours. Mean-value weights would ask for a star without flips. A vertex outside that
// hull is what has to give: it goes to the middle of its neighbours.
#include "core/solve/repair/virtual_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear/dominant_lu.hpp"
#include "core/linear/eliminate.hpp"
#include "core/solve/maps/fill_holes.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kRimRadius = 2;  // of the map's farthest vertex
constexpr int kMostEntropySteps = 60;
constexpr double kBalanced = 1e-13;  // of the neighbours' mean distance
constexpr double kLeastWeight = 1e-9;

/// The disk without holes, inside a ring of virtual triangles.
struct PaddedDisk {
  std::vector<Triangle> faces;
  UvMap uv;
  std::size_t rim = 0;  ///< vertices from this one on are the rim
};

/// Places the rim's vertices on a circle, one for each of the loop, rotated to lie near them.
void append_rim(const std::vector<Index>& loop, UvMap& uv) {
  Vec2 centre = Vec2::Zero();
  for (const Vec2& u : uv) centre += u / static_cast<double>(uv.size());
  double reach = 0;
  for (const Vec2& u : uv) reach = std::max(reach, (u - centre).norm());
  const double step = 2 * std::numbers::pi / static_cast<double>(loop.size());
  double x = 0, y = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 d = uv[loop[k]] - centre;
    const double c = std::cos(step * double(k)), s = std::sin(step * double(k));
    x += d.x() * c + d.y() * s;
    y += d.y() * c - d.x() * s;
  }
  const double turn = std::atan2(y, x);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const double angle = turn + step * static_cast<double>(k);
    uv.push_back(centre +
                 kRimRadius * std::max(reach, 1e-9) * Vec2(std::cos(angle), std::sin(angle)));
  }
}

PaddedDisk pad(const Disk& disk, const UvMap& map) {
  const maps::FilledDisk filled = maps::fill_holes(disk);
  PaddedDisk p{filled.faces, map, 0};
  std::vector<Vec2> sum(filled.disk.positions.size(), Vec2::Zero());
  std::vector<int> count(sum.size(), 0);
  for (const Triangle& face : filled.faces)  // the middle of each hole, of its own loop
    for (Index v : face)
      for (Index w : face)
        if (w < disk.vertex_count()) sum[v] += map[w], ++count[v];
  for (std::size_t v = map.size(); v < sum.size(); ++v) p.uv.push_back(sum[v] / count[v]);
  p.rim = p.uv.size();
  std::vector<Index> loop;
  for (Index h : filled.loops.front()) loop.push_back(filled.faces[h / 3][h % 3]);
  append_rim(loop, p.uv);
  const auto rim = [&](std::size_t k) { return static_cast<Index>(p.rim + k); };
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::size_t next = (k + 1) % loop.size();
    p.faces.push_back({loop[next], loop[k], rim(k)});
    p.faces.push_back({loop[next], rim(k), rim(next)});
  }
  return p;
}

/// The positive weights of greatest entropy, adding up to 1, under which the offsets balance;
/// empty when the origin is not inside their hull. Newton on log sum exp(slope . offset).
std::vector<double> balancing_weights(const std::vector<Vec2>& offset) {
  double size = 0;
  for (const Vec2& d : offset) size += d.norm() / static_cast<double>(offset.size());
  if (!(size > 0)) return {};
  std::vector<double> weight(offset.size());
  Vec2 slope = Vec2::Zero();
  for (int k = 0; k < kMostEntropySteps; ++k) {
    double sum = 0, highest = 0;
    for (const Vec2& d : offset) highest = std::max(highest, slope.dot(d) / size);
    for (std::size_t j = 0; j < weight.size(); ++j)
      sum += weight[j] = std::exp(slope.dot(offset[j]) / size - highest);
    Vec2 mean = Vec2::Zero();
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (std::size_t j = 0; j < weight.size(); ++j) {
      const Vec2 d = offset[j] / size;
      mean += (weight[j] /= sum) * d;
      spread += weight[j] * d * d.transpose();
    }
    if (mean.norm() < kBalanced) return weight;
    spread -= mean * mean.transpose();
    spread.diagonal().array() += 1e-14;
    const double det = spread(0, 0) * spread(1, 1) - spread(0, 1) * spread(1, 0);
    Vec2 step(spread(1, 1) * mean.x() - spread(0, 1) * mean.y(),
              spread(0, 0) * mean.y() - spread(1, 0) * mean.x());
    step /= det;
    slope -= step / std::max(1.0, step.norm());
  }
  return {};
}

/// Neighbours of each vertex inside the rim: the ends of its half-edges, counter-clockwise or not.
std::vector<std::vector<Index>> neighbours_of(const PaddedDisk& p) {
  std::vector<std::vector<Index>> neighbours(p.rim);
  for (const Triangle& face : p.faces)
    for (std::size_t i = 0; i < 3; ++i)
      if (static_cast<std::size_t>(face[i]) < p.rim)
        neighbours[face[i]].push_back(face[(i + 1) % 3]);
  return neighbours;
}

std::vector<double> weights_at(const PaddedDisk& p, std::size_t v,
                               const std::vector<Index>& around) {
  std::vector<Vec2> offset;
  for (Index w : around) offset.emplace_back(p.uv[w] - p.uv[v]);
  std::vector<double> weight = balancing_weights(offset);
  if (weight.empty()) weight.assign(around.size(), 1 / static_cast<double>(around.size()));
  for (double& w : weight) w = std::max(w, kLeastWeight);
  return weight;
}

}  // namespace

UvMap virtual_boundary_map(const Disk& disk, const UvMap& uv) {
  const PaddedDisk p = pad(disk, uv);
  const auto neighbours = neighbours_of(p);
  std::vector<Eigen::Triplet<double, Index>> entries;
  std::vector<Vec2> x(p.rim, Vec2::Zero());
  for (std::size_t v = 0; v < p.rim; ++v) {
    const std::vector<double> weight = weights_at(p, v, neighbours[v]);
    const auto row = static_cast<Index>(v);
    for (std::size_t k = 0; k < weight.size(); ++k) {
      const Index w = neighbours[v][k];
      entries.emplace_back(row, row, weight[k]);
      if (static_cast<std::size_t>(w) < p.rim)
        entries.emplace_back(row, w, -weight[k]);
      else
        x[v] += weight[k] * p.uv[w];
    }
  }
  linear::SparseMatrix matrix(static_cast<Index>(p.rim), static_cast<Index>(p.rim));
  matrix.setFromTriplets(entries.begin(), entries.end());
  linear::solve_dominant(matrix, x, disk.stop);
  x.resize(uv.size());
  return x;
}

}  // namespace unwrapd::solve::repair
