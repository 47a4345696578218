// Rotations are all that ARAP lacks: given one for each triangle, a global step gives the map.
// Neighbours that unfold onto each other tell their rotations apart, and on a developable disk they
// tell them without contradiction. Elsewhere what a walk around a vertex sees is its curvature.
// Log scale factors u with L u = -K inside and u = 0 on the boundary make the metric flat, to first
// order (Ben-Chen, Gotsman, Bunin 2008; Sawhney, Crane 2017, Eq. 12), and turn neighbours across
// the edge ij by (cot + cot) / 2 (u_i - u_j). That closes around every inner vertex exactly, so
// that with one boundary any tree carries the same rotations everywhere.
//
// Rejected: rotations carried without u (on closed shapes cut open they contradict each other where
// branches meet; descents take twice as long); u from the matrix of the global step with its
// natural boundary (no factorisation, but long boundaries wind up: Cow starts at an energy of 0.54
// instead of 0.025); holes filled, to close around them too (the rims of a rolled sheet then look
// curved).
#include "core/solve/arap/initial_rotations.hpp"

#include <complex>

#include "core/base/cancel.hpp"
#include "core/linear/factor.hpp"
#include "core/mesh/edges.hpp"
#include "core/solve/arap/even_boundary_scale_factors.hpp"
#include "core/solve/base/metric.hpp"

namespace unwrapd::solve::arap {
namespace {

/// L with boundary rows and columns of the identity. It has the pattern of the global step's
/// matrix, so that one analysis serves both.
linear::SparseMatrix with_held_boundary(const Disk& disk, std::span<const char> on_boundary) {
  linear::SparseMatrix lower = cotan_laplacian(disk, disk.rest);
  for (Index j = 0; j < static_cast<Index>(lower.cols()); ++j) {
    check_cancelled_every(j, disk.stop);
    for (linear::SparseMatrix::InnerIterator it(lower, j); it; ++it)
      if (on_boundary[static_cast<std::size_t>(it.row())] != 0 ||
          on_boundary[static_cast<std::size_t>(j)] != 0)
        it.valueRef() = it.row() == j ? 1 : 0;
  }
  return lower;
}

constexpr std::size_t kWorthLevelling =
    8192;  // vertices; a smaller factor takes the time of a few solves
constexpr double kMostBoundary =
    32;  // squared, relative to the vertices; longer boundaries take many steps
constexpr int kMostSolves = 12;

bool is_soon_level(const Disk& disk) {
  double boundary = 0;
  for (const BoundaryLoop& loop : disk.loops) boundary += static_cast<double>(loop.size());
  const std::size_t count = disk.positions.size();
  return count >= kWorthLevelling && boundary * boundary <= kMostBoundary * double(count);
}

/// u, one a vertex: constant on the boundary, or nearly so if that needs no factor.
std::vector<double> log_scales(const Disk& disk, const GlobalStep& global) {
  const std::vector<char> on_boundary = boundary_vertices(disk);
  const std::vector<double> k = curvature(disk, disk.rest, global.executor());
  if (is_soon_level(disk))
    if (auto level = even_boundary_scale_factors(disk, global, k, kMostSolves))
      return std::move(*level);
  std::vector<Vec2> x(k.size(), Vec2::Zero());
  for (std::size_t v = 0; v < x.size(); ++v)
    if (on_boundary[v] == 0) x[v].x() = -k[v];
  global.solve_alike(with_held_boundary(disk, on_boundary), x);
  std::vector<double> u;
  u.reserve(x.size());
  for (const Vec2& value : x) u.push_back(value.x());
  return u;
}

double cotangent(const Disk& disk, Index h) {
  return disk.rest[static_cast<std::size_t>(h / 3)].cot[static_cast<std::size_t>(h % 3)];
}

/// Half-edge h in its rest triangle, backwards.
linear::Complex rest_edge(const Disk& disk, Index h) {
  const Vec2& e = disk.rest[static_cast<std::size_t>(h / 3)].edge[static_cast<std::size_t>(h % 3)];
  return {e.x(), e.y()};
}

/// The rotation of the face across half-edge h relative to that of h's face, times some length.
linear::Complex turn_across(const Disk& disk, std::span<const double> u, Index h, Index twin) {
  const double weight = (cotangent(disk, h) + cotangent(disk, twin)) / 2;
  const double rise = u[static_cast<std::size_t>(start_of(disk.faces, h))] -
                      u[static_cast<std::size_t>(end_of(disk.faces, h))];
  return -rest_edge(disk, h) * std::conj(rest_edge(disk, twin)) * std::polar(1.0, weight * rise);
}

/// The opposite half-edge of h. Without a list of twins it is searched among those that start at
/// the end of h: kNoTwin if there is none, or several.
Index twin_of(const Disk& disk, Index h) {
  if (!disk.twin.empty()) return disk.twin[static_cast<std::size_t>(h)];
  const Index start = start_of(disk.faces, h);
  const auto end = static_cast<std::size_t>(end_of(disk.faces, h));
  Index twin = kNoTwin;
  for (Index k = disk.corners.begin[end]; k < disk.corners.begin[end + 1]; ++k) {
    const Index g = disk.corners.corner[static_cast<std::size_t>(k)];
    if (end_of(disk.faces, g) != start) continue;
    if (twin != kNoTwin) return kNoTwin;
    twin = g;
  }
  return twin;
}

/// One rotation a face, propagated breadth first from face 0.
std::vector<linear::Complex> rotations(const Disk& disk, const GlobalStep& global) {
  const std::vector<double> u = log_scales(disk, global);
  std::vector<linear::Complex> rotation(disk.faces.size(), 0);
  std::vector<Index> reached{0};
  reached.reserve(rotation.size());
  rotation[0] = 1;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    check_cancelled_every(k, disk.stop);
    for (Index h = 3 * reached[k]; h < 3 * reached[k] + 3; ++h) {
      const Index twin = twin_of(disk, h);
      if (twin == kNoTwin || rotation[static_cast<std::size_t>(face_of(twin))] != 0.0) continue;
      const linear::Complex turned =
          rotation[static_cast<std::size_t>(reached[k])] * turn_across(disk, u, h, twin);
      rotation[static_cast<std::size_t>(face_of(twin))] = turned / std::sqrt(std::norm(turned));
      reached.push_back(face_of(twin));
    }
  }
  return rotation;
}

}  // namespace

UvMap map_from_rotations(const Disk& disk, const GlobalStep& global) {
  const std::vector<linear::Complex> rotation = rotations(disk, global);
  UvMap uv(disk.positions.size(), Vec2::Zero());  // the right-hand side of Eq. (4), then its map
  for (std::size_t t = 0; t < disk.faces.size(); ++t) {
    check_cancelled_every(t, disk.stop);
    for (std::size_t i = 0; i < 3; ++i) {
      const measure::RestTriangle& rest = disk.rest[t];
      const linear::Complex turned =
          rotation[t] * linear::Complex(rest.edge[i].x(), rest.edge[i].y());
      const Vec2 pull = rest.cot[i] * Vec2(turned.real(), turned.imag());
      uv[static_cast<std::size_t>(disk.faces[t][i])] += pull;
      uv[static_cast<std::size_t>(disk.faces[t][(i + 1) % 3])] -= pull;
    }
  }
  global.solve(uv);
  return uv;
}

}  // namespace unwrapd::solve::arap
