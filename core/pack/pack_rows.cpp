// Packing by shelves: islands in their smallest rectangles, the highest first, row upon row.
//
// Padding is in texels and the islands' common scale is unknown, so the page is tried at ever
// smaller scales until all rows fit. An attempt is linear, and about a hundred are made. Rows waste
// more than a skyline does, but 100,000 islands take a fraction of a second.
#include "core/pack/pack.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/pack/box.hpp"

namespace unwrapd::pack {
namespace {

constexpr double kLeastPadding = 1.0 / 256;  // texels; rounding UVs to float may take this much
constexpr double kScaleStep = 0.99;          // between one attempt and the next
constexpr int kRefinements = 12;             // bisections after a scale fits
constexpr double kSlack = 1 - 1e-9;          // of the scale, for rounding

/// In texels, without the padding at its left and lower border.
struct RowPage {
  Vec2 size = Vec2::Zero();
  double padding = 0;
};

RowPage page_of(const PageOptions& options, std::size_t island_count) {
  const double padding = std::max(kept_padding(options, island_count), kLeastPadding);
  const double height = options.height.value_or(options.resolution);
  return {Vec2(options.resolution - padding, height - padding), padding};
}

/// Calls place(island, lower left corner in texels) row by row; false if the page is full. order:
/// islands by falling height.
template <class Place>
bool fill_rows(const std::vector<Box>& boxes, const std::vector<Index>& order, double scale,
               const RowPage& page, Place place) {
  double x = 0, y = 0, row_height = 0;
  for (Index k : order) {
    const Vec2 need = scale * boxes[k].size + Vec2::Constant(page.padding);
    if (x + need.x() > page.size.x()) {
      x = 0;
      y += row_height;
      row_height = 0;
    }
    row_height = std::max(row_height, need.y());
    if (x + need.x() > page.size.x() || y + row_height > page.size.y()) return false;
    place(k, Vec2(x + page.padding, y + page.padding));
    x += need.x();
  }
  return true;
}

struct Layout {
  std::vector<Box> boxes;
  std::vector<Index> order;
  double scale = 0;  ///< texels a unit of the islands
};

bool fits(const Layout& layout, double scale, const RowPage& page) {
  return fill_rows(layout.boxes, layout.order, scale, page, [](Index, const Vec2&) {});
}

/// A scale that this page can hold barely or not at all.
double scale_bound(const std::vector<Box>& boxes, const RowPage& page) {
  double area = 0;
  Vec2 longest = Vec2::Zero();
  for (const Box& box : boxes) {
    area += box.size.x() * box.size.y();
    longest = longest.cwiseMax(box.size);
  }
  if (longest == Vec2::Zero()) return 1;  // islands of no extent fit at any scale
  double bound = area > 0 ? std::sqrt(page.size.prod()) / std::sqrt(area)
                          : std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i)
    if (longest[i] > 0) bound = std::min(bound, (page.size[i] - page.padding) / longest[i]);
  return bound;
}

/// The largest scale at which the rows fit, among those tried.
Layout lay_rows(std::vector<Box> boxes, const RowPage& page) {
  Layout layout{std::move(boxes), {}, 0};
  layout.order.resize(layout.boxes.size());
  std::iota(layout.order.begin(), layout.order.end(), 0);
  std::stable_sort(layout.order.begin(), layout.order.end(), [&](Index a, Index b) {
    return size_rank(layout.boxes[a].size.y()) > size_rank(layout.boxes[b].size.y());
  });
  double too_large = scale_bound(layout.boxes, page) * kSlack;
  layout.scale = too_large;
  if (fits(layout, layout.scale, page)) return layout;
  do {
    too_large = layout.scale;
    layout.scale *= kScaleStep;
  } while (!fits(layout, layout.scale, page));
  for (int k = 0; k < kRefinements; ++k) {
    const double middle = (layout.scale + too_large) / 2;
    (fits(layout, middle, page) ? layout.scale : too_large) = middle;
  }
  return layout;
}

std::vector<Placement> pack_boxes(const std::vector<std::vector<Box>>& ways,
                                  const PageOptions& options) {
  const RowPage page = page_of(options, ways.front().size());
  Layout best;
  for (const std::vector<Box>& boxes : ways) {
    Layout own = lay_rows(boxes, page);
    if (best.boxes.empty() || own.scale > best.scale) best = std::move(own);
  }
  std::vector<Placement> placements(best.boxes.size());
  const double scale = best.scale * kSlack / options.resolution;
  fill_rows(best.boxes, best.order, best.scale, page, [&](Index k, const Vec2& corner) {
    const Box& box = best.boxes[k];
    placements[k] = {box.cosine, box.sine, scale, corner / options.resolution - scale * box.low};
  });
  return placements;
}

/// Rotates all boxes to lie flat, or to stand upright.
std::vector<Box> orient(std::vector<Box> boxes, bool standing) {
  for (Box& box : boxes)
    if ((box.size.y() > box.size.x()) != standing) box = box.turned_by_quarter();
  return boxes;
}

}  // namespace

/// At most half of the page is padding; more would leave the islands no room.
double kept_padding(const PageOptions& page, std::size_t island_count) {
  const auto count = static_cast<double>(island_count);
  const double columns = std::ceil(std::sqrt(count / page.aspect())) + 1;
  const double rows = std::ceil(std::sqrt(count * page.aspect())) + 1;
  return std::min({static_cast<double>(page.padding), page.resolution / (2 * columns),
                   page.height.value_or(page.resolution) / (2 * rows)});
}

std::vector<Placement> pack_in_rows(std::span<const UvMap> islands, const PageOptions& options) {
  assert(options.resolution > 0 && options.padding >= 0);
  if (islands.empty()) return {};
  std::vector<Box> boxes(islands.size());
  std::transform(islands.begin(), islands.end(), boxes.begin(), [&](const UvMap& island) {
    return islands.size() == 1 ? squarest_box(island, options.aspect()) : smallest_box(island);
  });
  return pack_boxes({orient(boxes, false), orient(boxes, true)}, options);
}

std::vector<Placement> pack_outlines_in_rows(std::span<const charts::Outline> islands,
                                             const PageOptions& options) {
  std::vector<Box> boxes;
  for (const charts::Outline& island : islands)
    boxes.push_back(resting_box(island, options.packing.rotation));
  if (options.packing.rotation == Rotation::none) return pack_boxes({boxes}, options);
  return pack_boxes({orient(boxes, false), orient(boxes, true)}, options);
}

}  // namespace unwrapd::pack
