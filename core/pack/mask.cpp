// Conservative scan conversion: a segment touches a range of cells in each row that it crosses;
// what lies between two crossings of the rows' middles is inside. Growing is a union of shifted and
// widened runs, one shift for each row of the padding's disk (Minkowski sum of cells and disk).
#include "core/pack/mask.hpp"

#include <algorithm>
#include <cmath>

namespace unwrapd::pack {
namespace {

struct Crossing {
  double x = 0;
  int winding = 0;
};

/// One row while it is built.
struct Row {
  std::vector<Run> runs;
  std::vector<Crossing> crossings;  ///< of the line through the cells' middles
};

int cell(double x, int count) { return std::clamp(static_cast<int>(std::floor(x)), 0, count - 1); }

void touch(const Vec2& a, const Vec2& b, int width, std::vector<Row>& rows) {
  const bool rises = b.y() >= a.y();
  const Vec2 &low = rises ? a : b, &high = rises ? b : a;
  const int height = static_cast<int>(rows.size());
  const double slope = high.y() > low.y() ? (high.x() - low.x()) / (high.y() - low.y()) : 0;
  for (int y = cell(low.y(), height); y <= cell(high.y(), height); ++y) {
    const double from = std::max<double>(low.y(), y), to = std::min<double>(high.y(), y + 1);
    const bool is_level = !(high.y() > low.y());
    const double p = is_level ? low.x() : low.x() + (from - low.y()) * slope;
    const double q = is_level ? high.x() : low.x() + (to - low.y()) * slope;
    Row& row = rows[static_cast<std::size_t>(y)];
    row.runs.push_back({cell(std::min(p, q), width), cell(std::max(p, q), width) + 1});
    const double middle = y + 0.5;
    if (low.y() <= middle && middle < high.y())
      row.crossings.push_back({low.x() + (middle - low.y()) * slope, rises ? 1 : -1});
  }
}

void fill_inside(Row& row, int width) {
  std::stable_sort(row.crossings.begin(), row.crossings.end(),
                   [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
  int winding = 0;
  for (std::size_t k = 0; k + 1 < row.crossings.size(); ++k) {
    winding += row.crossings[k].winding;
    if (winding != 0)
      row.runs.push_back(
          {cell(row.crossings[k].x, width), cell(row.crossings[k + 1].x, width) + 1});
  }
}

/// Sorts runs, joins those that touch or overlap, and appends them as the next row.
void append_row(std::vector<Run>& runs, Rows& rows) {
  std::stable_sort(runs.begin(), runs.end(),
                   [](const Run& a, const Run& b) { return a.begin < b.begin; });
  const auto row_begin = rows.runs.size();
  for (const Run& run : runs) {
    if (rows.runs.size() > row_begin && run.begin <= rows.runs.back().end)
      rows.runs.back().end = std::max(rows.runs.back().end, run.end);
    else
      rows.runs.push_back(run);
  }
  rows.first.push_back(static_cast<int>(rows.runs.size()));
}

/// reach[d]: the widest |dx| at |dy| = d at which a point of one cell can lie nearer than the
/// padding to one of the other; cells apart by (dx, dy) leave (|dx| - 1, |dy| - 1) between them.
std::vector<int> disk_rows(double padding) {
  std::vector<int> reach;
  for (int d = 0; d <= margin_of(padding); ++d) {
    const double dy = std::max(0, d - 1);
    const double dx = std::sqrt(std::max(padding * padding - dy * dy, 0.0));
    reach.push_back(static_cast<int>(std::ceil(dx)));  // |dx| - 1 < dx
  }
  return reach;
}

Rows grow(const Rows& touched, double padding) {
  const std::vector<int> reach = disk_rows(padding);
  const int margin = margin_of(padding);
  Rows grown;
  std::vector<Run> runs;
  for (int y = -margin; y < touched.height() + margin; ++y) {
    runs.clear();
    for (int s = std::max(0, y - margin); s <= std::min(touched.height() - 1, y + margin); ++s) {
      const int wide = reach[static_cast<std::size_t>(std::abs(s - y))];
      for (const Run& run : touched.row(s))
        runs.push_back({run.begin + margin - wide, run.end + margin + wide});
    }
    append_row(runs, grown);
  }
  return grown;
}

}  // namespace

int margin_of(double padding) { return static_cast<int>(std::ceil(padding)); }

Mask make_mask(const charts::Outline& outline, const Turn& turn, double padding) {
  Mask mask;
  mask.margin = margin_of(padding);
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (const auto& [a, b] : outline) {
    low = low.cwiseMin(turn(a));
    high = high.cwiseMax(turn(a));
  }
  mask.low = low;
  mask.width = std::max(1, static_cast<int>(std::ceil(high.x() - low.x())));
  std::vector<Row> rows(
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(high.y() - low.y()))));
  for (const auto& [a, b] : outline) touch(turn(a) - low, turn(b) - low, mask.width, rows);
  for (Row& row : rows) {
    fill_inside(row, mask.width);
    append_row(row.runs, mask.touched);
  }
  for (const Run& run : mask.touched.runs) mask.cells += run.end - run.begin;
  mask.grown = padding > 0 ? grow(mask.touched, padding) : mask.touched;
  return mask;
}

}  // namespace unwrapd::pack
