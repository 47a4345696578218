// Conservative scan conversion: a segment touches a range of cells in each row that it crosses;
// what lies between two crossings of the rows' middles is inside. Growing is a union of shifted and
// widened runs, one shift for each row of the padding's disk (Minkowski sum of cells and disk).
#include "core/pack/mask.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace unwrapd::pack {
namespace {

struct Crossing {
  double x = 0;
  int winding = 0;
};

int cell(double x, int count) { return std::clamp(static_cast<int>(std::floor(x)), 0, count - 1); }

/// What is found row by row, in one list: those of a row lie together, as they came.
template <class Item>
class ByRow {
 public:
  void add(int row, const Item& item) { found_.push_back({row, item}); }

  /// Called once, after the last item.
  void sort(std::size_t rows) {
    begin_.assign(rows + 1, 0);
    for (const Found& own : found_) ++begin_[static_cast<std::size_t>(own.row) + 1];
    for (std::size_t y = 0; y < rows; ++y) begin_[y + 1] += begin_[y];
    item_.resize(found_.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const Found& own : found_) item_[next[static_cast<std::size_t>(own.row)]++] = own.item;
  }
  [[nodiscard]] std::span<Item> row(std::size_t y) {
    return std::span(item_).subspan(begin_[y], begin_[y + 1] - begin_[y]);
  }

 private:
  struct Found {
    int row;
    Item item;
  };
  std::vector<Found> found_;
  std::vector<std::size_t> begin_;
  std::vector<Item> item_;
};

/// The rows of a mask while it is built.
struct Scan {
  int width = 0, height = 0;
  ByRow<Run> runs;
  ByRow<Crossing> crossings;  ///< of the lines through the cells' middles
};

void touch(const Vec2& a, const Vec2& b, Scan& scan) {
  const bool rises = b.y() >= a.y();
  const Vec2 &low = rises ? a : b, &high = rises ? b : a;
  const double slope = high.y() > low.y() ? (high.x() - low.x()) / (high.y() - low.y()) : 0;
  for (int y = cell(low.y(), scan.height); y <= cell(high.y(), scan.height); ++y) {
    const double from = std::max<double>(low.y(), y), to = std::min<double>(high.y(), y + 1);
    const bool is_level = !(high.y() > low.y());
    const double p = is_level ? low.x() : low.x() + (from - low.y()) * slope;
    const double q = is_level ? high.x() : low.x() + (to - low.y()) * slope;
    scan.runs.add(y, {cell(std::min(p, q), scan.width), cell(std::max(p, q), scan.width) + 1});
    const double middle = y + 0.5;
    if (low.y() <= middle && middle < high.y())
      scan.crossings.add(y, {low.x() + (middle - low.y()) * slope, rises ? 1 : -1});
  }
}

/// Appends the runs between the crossings of a row.
void fill_inside(std::span<Crossing> crossings, int width, std::vector<Run>& runs) {
  std::stable_sort(crossings.begin(), crossings.end(),
                   [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
  int winding = 0;
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    winding += crossings[k].winding;
    if (winding != 0)
      runs.push_back({cell(crossings[k].x, width), cell(crossings[k + 1].x, width) + 1});
  }
}

/// Sorts runs, joins those that touch or overlap, and appends them as the next row.
void append_row(std::vector<Run>& runs, Rows& rows) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
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
  Scan scan{mask.width, std::max(1, static_cast<int>(std::ceil(high.y() - low.y()))), {}, {}};
  for (const auto& [a, b] : outline) touch(turn(a) - low, turn(b) - low, scan);
  const auto rows = static_cast<std::size_t>(scan.height);
  scan.runs.sort(rows);
  scan.crossings.sort(rows);
  std::vector<Run> runs;
  for (std::size_t y = 0; y < rows; ++y) {
    runs.assign(scan.runs.row(y).begin(), scan.runs.row(y).end());
    fill_inside(scan.crossings.row(y), mask.width, runs);
    append_row(runs, mask.touched);
  }
  for (const Run& run : mask.touched.runs) mask.cells += run.end - run.begin;
  mask.grown = padding > 0 ? grow(mask.touched, padding) : mask.touched;
  return mask;
}

}  // namespace unwrapd::pack
