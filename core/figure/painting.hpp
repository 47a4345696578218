#pragma once
// What a picture of a layout is made of, whichever way it is drawn: a colour for each face, and the
// edges at which an island ends.

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "core/figure/colour_scale.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// Instead of a colour's number.
inline constexpr std::uint8_t kFlippedFace = 254;
inline constexpr std::uint8_t kHiddenFace = 255;  ///< no area in 3D: left out

/// One entry for each face of each surface: the number of its colour in colour_scale(colouring),
/// kFlippedFace where sigma_min <= 0, or kHiddenFace. unwrapped has one entry for each surface.
std::vector<std::vector<std::uint8_t>> painted_faces(std::span<const Surface> surfaces,
                                                     std::span<const UnwrappedSurface> unwrapped,
                                                     Colouring colouring);

/// A convex polygon of UV space, counter-clockwise.
using Polygon = std::vector<Vec2>;

/// Where two triangles of the page share texels, be it of one island or of two: the intersection of
/// each such pair, of at most kMostOverlaps. Throws Error{cancelled}.
std::vector<Polygon> overlap_polygons(std::span<const UnwrappedSurface> unwrapped,
                                      const std::stop_token& stop);

inline constexpr std::size_t kMostOverlaps = 200'000;

/// The part of a polygon where low <= normal . p <= high; empty if there is none.
Polygon clipped(const Polygon& polygon, const Vec2& normal, double low, double high);

using Edge = std::array<Index, 2>;  ///< vertices of an UnwrappedSurface

/// The edges that have a face on one side only of the page. Found by place, since vertices may be
/// split for other reasons than a seam.
std::vector<Edge> outline(const UnwrappedSurface& surface);

/// All other edges, each once.
std::vector<Edge> inner_edges(const UnwrappedSurface& surface);

/// The half-edges on each edge of the page, in the order of edges; found by place. Faces that
/// repeat a place have none.
std::vector<EdgeSide> sides_on_page(const UnwrappedSurface& surface);

/// The square of UV space that a picture shows: the page [0,1]^2, or a greater one about all
/// islands where positions were prescribed that lie off the page.
struct Frame {
  Vec2 corner = Vec2::Zero();  ///< of least u and v
  double side = 1;             ///< > 0

  /// In [0,1]^2.
  [[nodiscard]] Vec2 place(const Vec2& uv) const { return (uv - corner) / side; }
};

/// Lines between places on the page.
struct PageBorders {
  UvMap uv;
  std::vector<Edge> edges;
};

/// The borders of pages that are shown beside each other; none of a single one.
PageBorders page_borders(const LayoutLook& look);

/// About all islands, and all pages if there are several.
Frame frame_of(std::span<const UnwrappedSurface> unwrapped, const PageBorders& pages = {});

}  // namespace unwrapd::figure
