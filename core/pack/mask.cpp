// Conservative scan conversion: a segment touches a range of cells in each row that it crosses;
// what lies between two crossings of the rows' middles is inside. Growing is a union of shifted and
// widened runs, one shift for each row of the padding's disk (Minkowski sum of cells and disk).
#include "core/pack/mask.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

namespace unwrapd::pack {
namespace {

constexpr std::size_t kFewInARow = 16;
constexpr std::size_t kUsuallyInARow = 4;  // runs that are found

struct Crossing {
  double x = 0;
  int winding = 0;
};

/// The cell of a coordinate, clamped: below 0, truncation gives the same as floor.
int cell(double x, int count) { return std::clamp(static_cast<int>(x), 0, count - 1); }

/// What is found row by row, in one list: those of a row lie together, as they came.
template <class Item>
class ByRow {
 public:
  void reserve(std::size_t count) { found_.reserve(count); }
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

/// The cells of one row, as bits.
class RowBits {
 public:
  explicit RowBits(int width)
      : words_(static_cast<std::size_t>((width + kBits - 1) / kBits), 0), first_(words_.size()) {}

  void set(const Run& run) {
    const auto first = static_cast<std::size_t>(run.begin / kBits);
    const auto last = static_cast<std::size_t>((run.end - 1) / kBits);
    const std::uint64_t from = ~std::uint64_t{0} << (run.begin % kBits);
    const std::uint64_t to = ~std::uint64_t{0} >> (kBits - 1 - (run.end - 1) % kBits);
    if (first == last) {
      words_[first] |= from & to;
    } else {
      words_[first] |= from;
      for (std::size_t w = first + 1; w < last; ++w) words_[w] = ~std::uint64_t{0};
      words_[last] |= to;
    }
    first_ = std::min(first_, first);
    end_ = std::max(end_, last + 1);
  }

  /// Appends the runs of cells as the next row, and clears them.
  void move_to(Rows& rows) {
    int begin = -1;
    std::uint64_t before = 0;  // the last cell of the word before
    for (std::size_t w = first_; w < end_; ++w) {
      for (std::uint64_t ends = words_[w] ^ (words_[w] << 1 | before); ends != 0;
           ends &= ends - 1) {
        const int x = static_cast<int>(w) * kBits + std::countr_zero(ends);
        if (begin >= 0) rows.runs.push_back({begin, x});
        begin = begin >= 0 ? -1 : x;
      }
      before = words_[w] >> (kBits - 1);
      words_[w] = 0;
    }
    if (begin >= 0) rows.runs.push_back({begin, static_cast<int>(end_) * kBits});
    rows.first.push_back(static_cast<int>(rows.runs.size()));
    first_ = words_.size();
    end_ = 0;
  }

 private:
  static constexpr int kBits = 64;

  std::vector<std::uint64_t> words_;
  std::size_t first_, end_ = 0;  ///< words in which there are cells
};

/// The rows of a mask while it is built.
class Scan {
 public:
  Scan(int width, int height)
      : width_(width), height_(height), newest_(static_cast<std::size_t>(height)) {
    runs.reserve(kUsuallyInARow * newest_.size());
    crossings.reserve(kUsuallyInARow * newest_.size());
  }

  /// Most segments lie in one row and cross no middle.
  void touch(const Vec2& a, const Vec2& b) {
    const bool rises = b.y() >= a.y();
    const Vec2 &low = rises ? a : b, &high = rises ? b : a;
    const int first = cell(low.y(), height_), last = cell(high.y(), height_);
    if (first == last) add_run(first, low.x(), high.x());
    if (first == last && (low.y() > first + 0.5 || high.y() <= first + 0.5)) return;
    const double slope = (high.x() - low.x()) / (high.y() - low.y());
    for (int y = first; y <= last; ++y) {
      const double from = std::max<double>(low.y(), y), to = std::min<double>(high.y(), y + 1);
      if (first != last)
        add_run(y, low.x() + (from - low.y()) * slope, low.x() + (to - low.y()) * slope);
      const double middle = y + 0.5;
      if (low.y() <= middle && middle < high.y())
        crossings.add(y, {low.x() + (middle - low.y()) * slope, rises ? 1 : -1});
    }
  }

  /// Called once, after the last segment; the number of rows.
  std::size_t sort() {
    runs.sort(newest_.size());
    crossings.sort(newest_.size());
    return newest_.size();
  }

  ByRow<Run> runs;
  ByRow<Crossing> crossings;  ///< of the lines through the cells' middles

 private:
  /// The next segment often begins in the cells where the last one ended.
  void add_run(int y, double p, double q) {
    const Run run{cell(std::min(p, q), width_), cell(std::max(p, q), width_) + 1};
    Run& newest = newest_[static_cast<std::size_t>(y)];
    if (newest.begin <= run.begin && run.end <= newest.end) return;
    newest = run;
    runs.add(y, run);
  }

  int width_, height_;
  std::vector<Run> newest_;  ///< of each row
};

/// By insertion where they are few: std::stable_sort takes memory for each row.
void sort_by_x(std::span<Crossing> crossings) {
  if (crossings.size() > kFewInARow) {
    std::ranges::stable_sort(crossings, {}, &Crossing::x);
    return;
  }
  for (std::size_t k = 1; k < crossings.size(); ++k)
    for (std::size_t i = k; i > 0 && crossings[i].x < crossings[i - 1].x; --i)
      std::swap(crossings[i], crossings[i - 1]);
}

/// Sets the cells between the crossings of a row.
void fill_inside(std::span<Crossing> crossings, int width, RowBits& row) {
  sort_by_x(crossings);
  int winding = 0;
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    winding += crossings[k].winding;
    if (winding != 0) row.set({cell(crossings[k].x, width), cell(crossings[k + 1].x, width) + 1});
  }
}

/// Joins sorted runs that touch or overlap, and appends them as the next row.
void append_sorted(std::span<const Run> runs, Rows& rows) {
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

/// Rows that are united, each widened by its own reach and moved by the margin.
struct Stack {
  const Rows& touched;
  std::span<const int> reach;
  int first, last, middle;  ///< rows
  int margin;

  [[nodiscard]] Run widened(const Run& run, int row) const {
    const int wide = reach[static_cast<std::size_t>(std::abs(row - middle))];
    return {run.begin + margin - wide, run.end + margin + wide};
  }
};

/// What all k-th runs of some rows have in common, and their hull.
struct Column {
  Run common, hull;

  void join(const Run& run) {
    common = {std::max(common.begin, run.begin), std::min(common.end, run.end)};
    hull = {std::min(hull.begin, run.begin), std::max(hull.end, run.end)};
  }
};

/// The union of rows of equally many runs, if for every k all k-th runs have a cell or an end in
/// common: it consists of the hulls. Nearly all rows are of this kind, and need no sorting.
bool unite_alike(const Stack& stack, std::vector<Column>& columns, std::vector<Run>& runs) {
  const std::size_t count = stack.touched.row(stack.first).size();
  columns.clear();
  for (const Run& run : stack.touched.row(stack.first))
    columns.push_back({stack.widened(run, stack.first), stack.widened(run, stack.first)});
  for (int s = stack.first + 1; s <= stack.last; ++s) {
    const std::span<const Run> own = stack.touched.row(s);
    if (own.size() != count) return false;
    for (std::size_t k = 0; k < count; ++k) columns[k].join(stack.widened(own[k], s));
  }
  for (const Column& own : columns) {
    if (own.common.begin > own.common.end) return false;
    runs.push_back(own.hull);
  }
  return true;
}

Rows grow(const Rows& touched, int width, double padding) {
  const std::vector<int> reach = disk_rows(padding);
  const int margin = margin_of(padding);
  Rows grown;
  grown.runs.reserve(touched.runs.size() + static_cast<std::size_t>(2 * margin));
  grown.first.reserve(static_cast<std::size_t>(touched.height() + 2 * margin + 1));
  std::vector<Run> runs;
  std::vector<Column> columns;
  RowBits row(width + 2 * margin);
  for (int y = -margin; y < touched.height() + margin; ++y) {
    const Stack stack{
        touched, reach, std::max(0, y - margin), std::min(touched.height() - 1, y + margin),
        y,       margin};
    runs.clear();
    if (unite_alike(stack, columns, runs)) {
      append_sorted(runs, grown);
      continue;
    }
    for (int s = stack.first; s <= stack.last; ++s)
      for (const Run& run : touched.row(s)) row.set(stack.widened(run, s));
    row.move_to(grown);
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
  Scan scan(mask.width, std::max(1, static_cast<int>(std::ceil(high.y() - low.y()))));
  for (const auto& [a, b] : outline) scan.touch(turn(a) - low, turn(b) - low);
  const std::size_t rows = scan.sort();
  RowBits row(mask.width);
  for (std::size_t y = 0; y < rows; ++y) {
    for (const Run& run : scan.runs.row(y)) row.set(run);
    fill_inside(scan.crossings.row(y), mask.width, row);
    row.move_to(mask.touched);
  }
  for (const Run& run : mask.touched.runs) mask.cells += run.end - run.begin;
  mask.grown = padding > 0 ? grow(mask.touched, mask.width, padding) : mask.touched;
  return mask;
}

}  // namespace unwrapd::pack
