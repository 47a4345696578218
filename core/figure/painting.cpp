#include "core/figure/painting.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/measure/overlaps.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kSlack = 1e-6;  // of the page: rounding does not change the frame

/// The face laid flat; area 0 when it has none.
measure::RestTriangle laid_flat(const Vec3& a, const Vec3& b, const Vec3& c) {
  measure::RestTriangle rest;
  const double base = (b - a).norm(), twice_area = (b - a).cross(c - a).norm();
  if (!(twice_area > 0)) return rest;
  const double foot = (b - a).dot(c - a) / base, height = twice_area / base;
  rest.edge = {Vec2(-base, 0), Vec2(base - foot, -height), Vec2(foot, height)};
  rest.area = twice_area / 2;
  return rest;
}

/// Calls visit(face number, area, jacobian) for every face with an area, in units of the scene.
template <class Visit>
void for_each_face(const Surface& surface, const UnwrappedSurface& unwrapped, Visit visit) {
  const TriMesh& mesh = surface.mesh;
  const auto at = [&](Index v) { return Vec3(surface.scale * mesh.positions[v]); };
  for (std::size_t t = 0; t < mesh.faces.size(); ++t) {
    const auto& [a, b, c] = mesh.faces[t];
    const measure::RestTriangle rest = laid_flat(at(a), at(b), at(c));
    if (rest.area > 0)
      visit(t, rest.area,
            measure::jacobian(rest, measure::uv_edges(unwrapped.faces[t], unwrapped.uv)));
  }
}

/// The scale of UVs that makes UV area = 3D area.
double common_scale(std::span<const Surface> surfaces,
                    std::span<const UnwrappedSurface> unwrapped) {
  double area = 0, uv_area = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for_each_face(surfaces[s], unwrapped[s],
                  [&](std::size_t, double a, const measure::Jacobian& j) {
                    area += a;
                    uv_area += a * std::abs(j.determinant());
                  });
  }
  return uv_area > 0 ? std::sqrt(area / uv_area) : 1;
}

constexpr double kEndless = std::numeric_limits<double>::infinity();

Polygon counter_clockwise(const Triangle& face, const UvMap& uv) {
  Polygon corners = {uv[face[0]], uv[face[1]], uv[face[2]]};
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0];
  if (a.x() * b.y() - a.y() * b.x() < 0) std::swap(corners[1], corners[2]);
  return corners;
}

/// The part where normal . p >= least.
Polygon above_line(const Polygon& polygon, const Vec2& normal, double least) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2& from = polygon[k];
    const Vec2& to = polygon[(k + 1) % polygon.size()];
    const double a = normal.dot(from) - least, b = normal.dot(to) - least;
    if (a >= 0) kept.push_back(from);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept.emplace_back(from + a / (a - b) * (to - from));
  }
  return kept;
}

std::vector<Edge> edges_of(const UnwrappedSurface& surface, bool at_the_end) {
  const std::vector<EdgeSide> sides = sides_on_page(surface);
  std::vector<Edge> edges;
  for_each_run(sides, on_one_edge, [&](const EdgeSide* first, const EdgeSide* last) {
    if ((last - first == 1) != at_the_end) return;
    edges.push_back(
        {start_of(surface.faces, first->halfedge), end_of(surface.faces, first->halfedge)});
  });
  return edges;
}

}  // namespace

std::vector<std::vector<std::uint8_t>> painted_faces(std::span<const Surface> surfaces,
                                                     std::span<const UnwrappedSurface> unwrapped,
                                                     Colouring colouring) {
  assert(surfaces.size() == unwrapped.size());
  const double scale = common_scale(surfaces, unwrapped);
  const ColourScale& colours = colour_scale(colouring);
  std::vector<std::vector<std::uint8_t>> painted(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    painted[s].assign(surfaces[s].mesh.faces.size(), kHiddenFace);
    for_each_face(
        surfaces[s], unwrapped[s], [&](std::size_t t, double, const measure::Jacobian& j) {
          painted[s][t] = j.sigma_min() > 0 ? colours.colour_of(shown_value(colouring, j, scale))
                                            : kFlippedFace;
        });
  }
  return painted;
}

std::vector<Polygon> overlap_polygons(std::span<const UnwrappedSurface> unwrapped,
                                      const std::stop_token& stop) {
  std::vector<Triangle> faces;
  UvMap uv;
  for (const UnwrappedSurface& surface : unwrapped) {
    const auto first = static_cast<Index>(uv.size());
    for (const Triangle& face : surface.faces)
      faces.push_back({face[0] + first, face[1] + first, face[2] + first});
    uv.insert(uv.end(), surface.uv.begin(), surface.uv.end());
  }
  std::vector<Polygon> polygons;
  for (const auto& [s, t] : measure::overlapping_pairs(faces, uv, kMostOverlaps, stop)) {
    if (std::ranges::is_permutation(faces[s], faces[t])) continue;  // a face that the file repeats
    Polygon polygon = counter_clockwise(faces[s], uv);
    const Polygon other = counter_clockwise(faces[t], uv);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 along = other[(k + 1) % 3] - other[k], inwards(-along.y(), along.x());
      polygon = clipped(polygon, inwards, inwards.dot(other[k]), kEndless);
    }
    if (polygon.size() > 2) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

Polygon clipped(const Polygon& polygon, const Vec2& normal, double low, double high) {
  const Polygon above = above_line(polygon, normal, low);
  return above_line(above, -normal, -high);
}

std::vector<EdgeSide> sides_on_page(const UnwrappedSurface& surface) {
  std::vector<Vec3> places(surface.uv.size());
  for (std::size_t v = 0; v < places.size(); ++v) places[v] << surface.uv[v], 0;
  const std::vector<Triangle> faces = renumber(surface.faces, weld(places));
  auto sides = edge_sides(faces, [&](Index h) { return !repeats_vertex(faces[face_of(h)]); });
  sort_by_edge(sides, static_cast<Index>(places.size()));
  return sides;
}

std::vector<Edge> outline(const UnwrappedSurface& surface) { return edges_of(surface, true); }

std::vector<Edge> inner_edges(const UnwrappedSurface& surface) { return edges_of(surface, false); }

Frame frame_of(std::span<const UnwrappedSurface> unwrapped, const PageBorders& pages) {
  Vec2 low = Vec2::Zero(), high = Vec2::Ones();
  const auto include = [&](const UvMap& places) {
    for (const Vec2& uv : places) {
      low = low.cwiseMin(uv);
      high = high.cwiseMax(uv);
    }
  };
  for (const UnwrappedSurface& surface : unwrapped) include(surface.uv);
  include(pages.uv);
  const double side = (high - low).maxCoeff();
  if (!(low.minCoeff() < -kSlack || high.maxCoeff() > 1 + kSlack)) return {};
  return {.corner = (low + high) / 2 - Vec2::Constant(side / 2), .side = side};
}

PageBorders page_borders(const LayoutLook& look) {
  constexpr int kTilesARow = 10;
  PageBorders borders;
  if (look.is_cropped || look.page_count < 2) return borders;
  for (int page = 0; page < look.page_count; ++page) {
    const Vec2 corner(page % kTilesARow, page / kTilesARow);
    const auto first = static_cast<Index>(borders.uv.size());
    for (Index k = 0; k < 4; ++k) {
      const Vec2 across(k == 1 || k == 2 ? 1 : 0, k >= 2 ? 1 : 0);
      borders.uv.push_back((corner + across).cwiseProduct(look.tile));
      borders.edges.push_back({first + k, first + (k + 1) % 4});
    }
  }
  return borders;
}

}  // namespace unwrapd::figure
