#include "core/pack/row_prefix_sums.hpp"

#include <algorithm>
#include <array>

namespace unwrapd::pack {
namespace {

constexpr int kPlaces = 16;               // that are computed side by side
constexpr std::size_t kBlock = 128;       // entries of a column that are summed up together
constexpr std::size_t kEntriesAStep = 4;  // see work()
constexpr int kRowsTogether = 4;          // between two looks at whether places are left
constexpr int kStepsOfALook = 8, kStepsOfARow = 3;

/// kPlaces places of a column.
struct Places {
  std::array<std::int32_t, kPlaces> weight;
};

/// A mask over a column of places; its lowest row and leftmost column start at the first entry.
struct OverlapQuery {
  const Rows& rows;
  const std::int32_t* table;
  std::size_t stride;
  std::int32_t most;
};

/// Adds up the mask's rows, from the middle outwards, until every place weighs at least `most`.
/// Returns the number of rows. Only every few rows it looks whether all places do, since that takes
/// about as long as a row.
[[gnu::always_inline]] inline int weigh(const OverlapQuery& look, Places& places) {
  const int height = look.rows.height();
  std::array<std::int32_t, kPlaces> sum = places.weight;
  int k = 0;
  for (int below = 1; k < height && below != 0;) {
    for (const int end = std::min(k + kRowsTogether, height); k < end; ++k) {
      const int row = height / 2 + (k % 2 == 0 ? k / 2 : -(k + 1) / 2);
      const std::int32_t* own = look.table + row;
      std::array<std::int32_t, kPlaces> here{};
      for (const Run& run : look.rows.row(row)) {
        const std::int32_t* begin = own + static_cast<std::size_t>(run.begin) * look.stride;
        const std::int32_t* beyond = own + static_cast<std::size_t>(run.end) * look.stride;
        for (std::size_t i = 0; i < kPlaces; ++i) here[i] += beyond[i] - begin[i];
      }
      // beyond the column's end differences mean nothing
      for (std::size_t i = 0; i < kPlaces; ++i)
        sum[i] = std::min(sum[i] + std::max(here[i], 0), look.most);
    }
    below = 0;
    for (std::size_t i = 0; i < kPlaces; ++i) below |= sum[i] < look.most ? 1 : 0;
  }
  places.weight = sum;
  return k;
}

/// Columns of so many entries, a multiple of kPlaces, one after another.
struct Columns {
  std::int32_t* first;
  std::size_t size, count;
};

/// Turns differences into weights, and weights into sums over all cells to the left.
[[gnu::always_inline]] inline void sum_up(const Columns& table) {
  for (std::size_t y = 0; y < table.size; y += kBlock) {
    const std::size_t count = std::min(kBlock, table.size - y);
    std::array<std::int32_t, kBlock> here{}, sum{};
    for (std::size_t x = 0; x < table.count; ++x) {
      std::int32_t* own = table.first + x * table.size + y;
      for (std::size_t i = 0; i < count; ++i) {
        here[i] += own[i];
        own[i] = sum[i];
        sum[i] += here[i];
      }
    }
  }
}

/// The results do not depend on the length of registers.
struct Kernels {
  int (*weigh)(const OverlapQuery&, Places&);
  void (*sum_up)(const Columns&);
};

int weigh_on_baseline(const OverlapQuery& look, Places& places) { return weigh(look, places); }
[[gnu::target("avx2")]] int weigh_avx2(const OverlapQuery& look, Places& places) {
  return weigh(look, places);
}

void sum_up_on_baseline(const Columns& table) { sum_up(table); }
[[gnu::target("avx2")]] void sum_up_avx2(const Columns& table) { sum_up(table); }

const Kernels& kernels() {
  static const Kernels own = __builtin_cpu_supports("avx2") != 0
                                 ? Kernels{weigh_avx2, sum_up_avx2}
                                 : Kernels{weigh_on_baseline, sum_up_on_baseline};
  return own;
}

}  // namespace

int common_cells(std::span<const Run> a, std::span<const Run> b, int shift) {
  int count = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const int begin = std::max(a[i].begin, b[j].begin + shift);
    const int end = std::min(a[i].end, b[j].end + shift);
    count += std::max(0, end - begin);
    ++(a[i].end < b[j].end + shift ? i : j);
  }
  return count;
}

void RowPrefixSums::reset(const CellWindow& window) {
  window_ = window;
  const auto height = static_cast<std::size_t>(window.y_end - window.y_begin);
  const auto width = static_cast<std::size_t>(window.x_end - window.x_begin);
  stride_ = (height + kPlaces - 1) / kPlaces * kPlaces;
  table_.assign(stride_ * (width + 1) + kPlaces, 0);
}

void RowPrefixSums::take(const Rows& touched, int x, int y, std::int32_t weight) {
  const int first = std::max(window_.y_begin, y);
  const int last = std::min(window_.y_end, y + touched.height());
  const auto at = [&](int cell) {
    return column(std::clamp(x + cell, window_.x_begin, window_.x_end));
  };
  for (int row = first; row < last; ++row)
    for (const Run& run : touched.row(row - y)) {
      at(run.begin)[row - window_.y_begin] += weight;
      at(run.end)[row - window_.y_begin] -= weight;
    }
}

void RowPrefixSums::sum_up() {
  const auto count = static_cast<std::size_t>(window_.x_end - window_.x_begin + 1);
  kernels().sum_up({table_.data(), stride_, count});
  work_ += static_cast<std::int64_t>(table_.size() / kEntriesAStep);
}

LeastOverlap RowPrefixSums::least(const Mask& mask, int x, int y_begin, int y_last,
                                  std::int32_t most) {
  LeastOverlap best{y_begin, most};
  for (int y = y_begin; y <= y_last && best.weight > 0; y += kPlaces) {
    const OverlapQuery look{mask.grown,
                            column(x - mask.margin) + (y - mask.margin - window_.y_begin), stride_,
                            best.weight};
    Places places;
    for (int i = 0; i < kPlaces; ++i)
      places.weight[static_cast<std::size_t>(i)] = y + i <= y_last ? 0 : best.weight;
    work_ += kStepsOfALook + kStepsOfARow * kernels().weigh(look, places);
    const auto least = std::ranges::min_element(places.weight);
    if (*least < best.weight) best = {y + static_cast<int>(least - places.weight.begin()), *least};
  }
  if (best.weight == most) best.weight = kTooMuch;
  return best;
}

}  // namespace unwrapd::pack
