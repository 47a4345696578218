// Rounding costs nothing but the triangles of less than a few steps in height: slivers, and whole
// regions that a conformal map shrank to a point. They are untangled like any flip, in units of a
// step, on a disk whose triangles are the page's own with small ones enlarged: heights of a few
// steps survive rounding. Where they do not, larger ones are asked for.
//
// Moving single vertices to lattice points near by mends single slivers as well, but no regions.
#include "core/guarantee/quantize_uvs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/measure/orientation.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::guarantee {
namespace {

constexpr std::array<double, 9> kLeastHeights = {3, 6, 12, 25, 50, 100, 200, 400, 800};  // steps
constexpr double kMostEnlarged =
    200;  // least heights: up to this length small triangles are scaled
constexpr double kLeastLength = 1e-9;  // steps

/// kUvStep, or for what reaches beyond 1 the power of two at which the same holds.
double step_of(double reach) {
  double step = kUvStep;
  while (reach * kUvStep > step) step *= 2;
  return step;
}

/// To the nearest multiple of the finest step at which the coordinate can be written.
double finely_rounded(double coordinate) {
  const double step = step_of(std::max(std::abs(coordinate), std::abs(1 - coordinate)));
  return std::round(coordinate / step) * step;
}

/// In units of a step. Vertices that are held lie where they shall as exactly as can be written,
/// though the rest of the chart reaches further and is rounded to larger steps.
UvMap rounded(const UvMap& uv, std::span<const char> constrained, double step) {
  UvMap on_lattice(uv.size());
  for (std::size_t v = 0; v < uv.size(); ++v)
    if (!constrained.empty() && constrained[v] != 0)
      on_lattice[v] =
          Vec2(finely_rounded(uv[v].x() * step), finely_rounded(uv[v].y() * step)) / step;
    else
      on_lattice[v] = Vec2(std::round(uv[v].x()), std::round(uv[v].y()));
  return on_lattice;
}

/// The triangle laid on its longest side, of at least this height: a small one is enlarged as it
/// is, so that fans of needles find room, a long one is made higher.
measure::RestTriangle roomy(const std::array<Vec2, 3>& corner, double least_height) {
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if ((corner[(i + 1) % 3] - corner[i]).norm() > (corner[(k + 1) % 3] - corner[k]).norm()) k = i;
  const Vec2 base = corner[(k + 1) % 3] - corner[k], side = corner[(k + 2) % 3] - corner[k];
  const double given = std::max(base.norm(), kLeastLength);
  const double across = std::max((base.x() * side.y() - base.y() * side.x()) / given, 0.0);
  const double wanted = std::max(1.0, least_height / std::max(across, kLeastLength));
  const double larger = std::min(wanted, std::max(1.0, kMostEnlarged * least_height / given));
  const double length = given * larger;
  const Vec2 apex(side.dot(base) / given * larger, std::max(across * larger, least_height));
  measure::RestTriangle rest;
  rest.edge[k] = Vec2(-length, 0);
  rest.edge[(k + 1) % 3] = Vec2(length, 0) - apex;
  rest.edge[(k + 2) % 3] = apex;
  rest.area = length * apex.y() / 2;
  for (std::size_t i = 0; i < 3; ++i)
    rest.cot[i] = -rest.edge[(i + 1) % 3].dot(rest.edge[(i + 2) % 3]) / (2 * rest.area);
  return rest;
}

/// The chart as it lies on the page, in steps.
solve::Disk page_disk(const charts::Chart& chart, const UvMap& uv) {
  return {.faces = chart.mesh.faces,
          .loops = chart.loops,
          .positions = std::vector<Vec3>(uv.size(), Vec3::Zero()),
          .rest = {},
          .corners = linear::vertex_corners(chart.mesh.faces, chart.mesh.vertex_count())};
}

void set_least_height(double least_height, const UvMap& uv, solve::Disk& disk) {
  std::vector<measure::RestTriangle> rest;
  rest.reserve(disk.faces.size());
  for (const auto& [a, b, c] : disk.faces)
    rest.push_back(roomy({uv[a], uv[b], uv[c]}, least_height));
  disk.rest = std::move(rest);
}

}  // namespace

double uv_step(const UvMap& uv) {
  double reach = 1;
  for (const Vec2& u : uv) reach = std::max({reach, u.cwiseAbs().maxCoeff(), std::abs(1 - u.y())});
  return step_of(reach);
}

void round_to_step(UvMap& uv, std::span<const char> constrained) {
  const double step = uv_step(uv);
  for (Vec2& u : uv) u /= step;
  uv = rounded(uv, constrained, step);
  for (Vec2& u : uv) u *= step;
}

Index quantize_uvs(const charts::Chart& chart, const std::vector<char>& constrained,
                   const std::stop_token& stop, UvMap& uv) {
  const double step = uv_step(uv);
  for (Vec2& u : uv) u /= step;
  UvMap best = rounded(uv, constrained, step);
  std::size_t flipped = measure::flipped_faces(chart.mesh.faces, best, stop).size();
  if (flipped > 0) {
    solve::Disk disk = page_disk(chart, uv);
    solve::repair::MapIntent intent{
        .rigidity = {}, .constrained = constrained, .stop = stop, .in_place = true};
    UvMap now = best;
    for (double height : kLeastHeights) {
      set_least_height(height, uv, disk);
      solve::repair::untangle(disk, intent, now);
      intent.rings *= 2;
      now = rounded(now, constrained, step);
      const std::size_t left = measure::flipped_faces(disk.faces, now).size();
      if (left < flipped) flipped = left, best = now;
      if (flipped == 0) break;
    }
  }
  for (std::size_t v = 0; v < uv.size(); ++v) uv[v] = best[v] * step;
  return static_cast<Index>(flipped);
}

}  // namespace unwrapd::guarantee
