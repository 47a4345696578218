// A z-buffer over samples, after Catmull 1974, with normals interpolated, after Phong 1975, and
// taken from the face itself where an edge is sharp. Both sides of a face are drawn, the inner one
// greyer. Rays would need a tree over the faces, to no visible gain without shadows.
#include "core/figure/preview.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/figure/bands.hpp"
#include "core/figure/colour_scale.hpp"
#include "core/figure/raster.hpp"
#include "core/figure/seam_lines.hpp"
#include "core/figure/shading.hpp"
#include "core/figure/view.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::figure {
namespace {

constexpr double kSeamWidth = 2.4 / 1024, kBoundaryWidth = 1.5 / 1024;  // of the picture's side
constexpr double kMinLinePixels = 0.8;                                  // pixels
constexpr double kLift = 0.004;  // of the extent: lines lie so much in front of their faces
constexpr double kMinChecks = 2, kMaxChecks = 4096;

/// A surface on the screen; one entry for each vertex of the mesh.
struct Projected {
  std::vector<ScreenPoint> at;
  std::vector<float> depth;
  std::vector<Vec3> normal;  ///< of the welded vertex, unit or zero
};

struct DepthTriangle {
  ScreenTriangle corners;
  std::array<float, 3> depth;
};

/// Part of a line, in front of the surface.
struct LinePart {
  DepthTriangle triangle;
  Rgb colour;
};

/// Calls visit(place in the band, weights) for the samples that nothing hides as yet.
template <class Visit>
void for_each_visible(const DepthTriangle& triangle, Band& band, Visit visit) {
  const std::array<float, 3>& depth = triangle.depth;
  scan(triangle.corners, band.rows(), band.columns(), [&](int row, const SampleRange& range) {
    const CornerWeights weights(triangle.corners, row);
    std::size_t place = band.place(row, range.first);
    for (int column = range.first; column < range.end; ++column, ++place) {
      const std::array<double, 3> weight = weights.at(column);
      const double here = weight[0] * depth[0] + weight[1] * depth[1] + weight[2] * depth[2];
      if (band.take_nearer(place, static_cast<float>(here))) visit(place, weight);
    }
  });
}

Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

/// Twice the area times the normal, in the view's units.
Vec3 face_normal(const TriMesh& mesh, const Triangle& face, const View& view) {
  const Vec3 a = mesh.positions[face[0]] / view.unit;
  return (mesh.positions[face[1]] / view.unit - a).cross(mesh.positions[face[2]] / view.unit - a);
}

std::vector<Vec3> vertex_normals(const TriMesh& mesh, const View& view) {
  const std::vector<Index> place = weld(mesh.positions);
  std::vector<Vec3> sum(mesh.positions.size(), Vec3::Zero());
  for (const Triangle& face : mesh.faces) {
    const Vec3 normal = face_normal(mesh, face, view);
    for (const Index v : face) sum[place[v]] += normal;
  }
  std::vector<Vec3> normal(sum.size());
  for (std::size_t v = 0; v < sum.size(); ++v) normal[v] = unit_or_zero(sum[place[v]]);
  return normal;
}

Projected projected(const TriMesh& mesh, const View& view) {
  Projected out{.at = {}, .depth = {}, .normal = vertex_normals(mesh, view)};
  for (const Vec3& position : mesh.positions) {
    out.at.push_back(snapped(view.pixel(position)));
    out.depth.push_back(static_cast<float>(view.depth(position)));
  }
  return out;
}

void append_line(std::vector<LinePart>& parts, const std::array<Vec3, 2>& ends, const View& view,
                 double width, const Rgb& colour) {
  const std::array<Vec2, 8> outline =
      line_outline(view.pixel(ends[0]), view.pixel(ends[1]), std::max(kMinLinePixels, width));
  std::array<float, 2> depth{};
  for (std::size_t k = 0; k < 2; ++k)
    depth[k] = static_cast<float>(view.depth(ends[k]) + kLift * view.extent);
  const auto depth_at = [&](std::size_t corner) { return depth[corner < 4 ? 1 : 0]; };
  for (std::size_t k = 2; k < outline.size(); ++k)
    parts.push_back({{{snapped(outline[0]), snapped(outline[k - 1]), snapped(outline[k])},
                      {depth_at(0), depth_at(k - 1), depth_at(k)}},
                     colour});
}

void append_lines(std::vector<LinePart>& parts, const Surface& surface,
                  const UnwrappedSurface& unwrapped, const View& view) {
  const double side = 2 * view.centre;
  for (const SeamLine& line : seam_lines(surface, unwrapped)) {
    const std::array<Vec3, 2> ends = {surface.mesh.positions[unwrapped.source[line.edge[0]]],
                                      surface.mesh.positions[unwrapped.source[line.edge[1]]]};
    append_line(parts, ends, view, side * (line.is_seam ? kSeamWidth : kBoundaryWidth),
                line.is_seam ? kSeamColour : kInk);
  }
}

/// Squares along the page's side.
double checks_of(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
                 const View& view) {
  double area = 0, uv_area = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (const Triangle& face : surfaces[s].mesh.faces)
      area += face_normal(surfaces[s].mesh, face, view).norm() / 2;
    for (const Triangle& face : unwrapped[s].faces) {
      const Vec2 a = unwrapped[s].uv[face[0]];
      const Vec2 b = unwrapped[s].uv[face[1]] - a, c = unwrapped[s].uv[face[2]] - a;
      uv_area += std::abs(b.x() * c.y() - b.y() * c.x()) / 2;
    }
  }
  const double across = view.extent / view.pixels;  // in the units of area
  const double checks = kChecksAcross / across * std::sqrt(area / uv_area);
  return checks >= kMinChecks ? std::round(std::min(checks, kMaxChecks)) : kMinChecks;
}

/// One surface, ready to be drawn face by face.
class Painter {
 public:
  Painter(const Surface& surface, const UnwrappedSurface& unwrapped, const View& view,
          double checks)
      : surface_(surface),
        unwrapped_(unwrapped),
        view_(view),
        checks_(checks),
        projected_(projected(surface.mesh, view)) {}

  [[nodiscard]] Index face_count() const { return surface_.mesh.face_count(); }

  [[nodiscard]] ScreenTriangle triangle(Index t) const {
    const auto& [a, b, c] = surface_.mesh.faces[t];
    return {projected_.at[a], projected_.at[b], projected_.at[c]};
  }

  void draw(Index t, Band& band) const {
    const auto& [a, b, c] = surface_.mesh.faces[t];
    const DepthTriangle face{triangle(t),
                             {projected_.depth[a], projected_.depth[b], projected_.depth[c]}};
    const FaceLook look = look_of(t);
    Lit colours{};
    std::size_t quad = std::numeric_limits<std::size_t>::max();
    for_each_visible(face, band, [&](std::size_t place, const auto& weight) {
      if (place / kSamples != quad) colours = lit(look, weight);  // slow, and changes slowly:
      quad = place / kSamples;  // once for the samples of a pixel in one row
      band.colour_at(place) = is_dark(look, weight, checks_) ? colours.dark : colours.light;
    });
  }

 private:
  [[nodiscard]] FaceLook look_of(Index t) const {
    const Vec3 normal = unit_or_zero(face_normal(surface_.mesh, surface_.mesh.faces[t], view_));
    const bool is_inside = normal.dot(view_.toward) < 0;
    FaceLook look{.normal = {}, .uv = {}, .is_inside = is_inside};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 n = corner_normal(normal, projected_.normal[surface_.mesh.faces[t][k]]);
      look.normal[k] =
          (is_inside ? -1 : 1) * Vec3(view_.right.dot(n), view_.up.dot(n), view_.toward.dot(n));
      look.uv[k] = unwrapped_.uv[unwrapped_.faces[t][k]];
    }
    return look;
  }

  const Surface& surface_;
  const UnwrappedSurface& unwrapped_;
  const View& view_;
  double checks_;
  Projected projected_;
};

void draw_line(const LinePart& part, Band& band) {
  for_each_visible(part.triangle, band,
                   [&](std::size_t place, const auto&) { band.colour_at(place) = part.colour; });
}

Image drawn(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
            const View& view, double checks, const std::stop_token& stop) {
  std::vector<Painter> painters;
  std::vector<LinePart> lines;
  std::vector<Index> first_face = {0};
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    throw_if_cancelled(stop);
    painters.emplace_back(surfaces[s], unwrapped[s], view, checks);
    append_lines(lines, surfaces[s], unwrapped[s], view);
    first_face.push_back(first_face.back() + painters.back().face_count());
  }
  const Index faces = first_face.back();
  const auto surface_of = [&](Index k) {
    return std::ranges::upper_bound(first_face, k) - first_face.begin() - 1;
  };
  const int size = static_cast<int>(std::lround(2 * view.centre));
  Image image = blank_image(size, size);
  draw_in_bands(
      {image, kPaper, stop}, faces + static_cast<Index>(lines.size()),
      [&](Index k) {
        const auto s = surface_of(k);
        return k < faces ? painters[s].triangle(k - first_face[s])
                         : lines[k - faces].triangle.corners;
      },
      [&](Index k, Band& band) {
        const auto s = surface_of(k);
        if (k < faces) return painters[s].draw(k - first_face[s], band);
        draw_line(lines[k - faces], band);
      });
  return image;
}

/// Eight views around the surfaces, all at one scale.
std::array<View, kTurntableViews> views_around(std::span<const Surface> surfaces, int size) {
  std::array<View, kTurntableViews> views;
  double pixels = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < views.size(); ++k) {
    const double turn = 360.0 * static_cast<double>(k) / kTurntableViews;
    views[k] = view_of(surfaces, size, Aspect{.azimuth = turn, .elevation = kTurntableElevation});
    pixels = std::min(pixels, views[k].pixels);
  }
  for (View& view : views) {
    view.extent *= pixels / view.pixels;
    view.pixels = pixels;
  }
  return views;
}

/// Copies a square picture to where its column and row begin in a sheet of such squares.
void place_on_sheet(const Image& picture, int column, int row, Image& sheet) {
  const std::ptrdiff_t line = std::ptrdiff_t{3} * picture.width;
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.rgb.begin() + y * line, line,
                sheet.rgb.begin() + 3 * (std::ptrdiff_t{row * picture.height + y} * sheet.width +
                                         std::ptrdiff_t{column} * picture.width));
}

}  // namespace

Image preview(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
              int size, const std::optional<Aspect>& aspect, const std::stop_token& stop) {
  assert(surfaces.size() == unwrapped.size());
  assert(size >= kMinImageSize && size <= kMaxImageSize);
  const View view = view_of(surfaces, size, aspect);
  return drawn(surfaces, unwrapped, view, checks_of(surfaces, unwrapped, view), stop);
}

Image turntable(std::span<const Surface> surfaces, std::span<const UnwrappedSurface> unwrapped,
                int size, const std::stop_token& stop) {
  assert(surfaces.size() == unwrapped.size());
  assert(size >= kMinImageSize && size <= kMaxImageSize);
  constexpr int kColumns = kTurntableViews / 2;
  const int side = size / kColumns;
  const std::array<View, kTurntableViews> views = views_around(surfaces, side);
  const double checks = checks_of(surfaces, unwrapped, views[0]);
  Image sheet = blank_image(kColumns * side, 2 * side);
  for (int k = 0; k < kTurntableViews; ++k) {
    const View& view = views[static_cast<std::size_t>(k)];
    place_on_sheet(drawn(surfaces, unwrapped, view, checks, stop), k % kColumns, k / kColumns,
                   sheet);
  }
  return sheet;
}

}  // namespace unwrapd::figure
