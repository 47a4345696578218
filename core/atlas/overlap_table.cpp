#include "core/atlas/overlap_table.hpp"

#include <algorithm>

namespace unwrapd {
namespace {

constexpr int kWorkOfALook = 4;  // rows' worth

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

void OverlapTable::reset(const CellWindow& window) {
  window_ = window;
  stride_ = static_cast<std::size_t>(window.x_end - window.x_begin) + 1;
  table_.assign(stride_ * static_cast<std::size_t>(window.y_end - window.y_begin), 0);
}

void OverlapTable::take(const Rows& touched, int x, int y, std::int32_t weight) {
  const int first = std::max(window_.y_begin, y);
  const int last = std::min(window_.y_end, y + touched.height());
  const auto entry = [&](int cell) {
    return std::clamp(x + cell, window_.x_begin, window_.x_end) - window_.x_begin;
  };
  for (int at = first; at < last; ++at)
    for (const Run& run : touched.row(at - y)) {
      row(at)[entry(run.begin)] += weight;
      row(at)[entry(run.end)] -= weight;
    }
}

/// Steps become weights, weights become sums of all to the left.
void OverlapTable::sum_up() {
  for (int y = window_.y_begin; y < window_.y_end; ++y) {
    std::int32_t* own = row(y);
    std::int32_t here = 0, sum = 0;
    for (std::size_t x = 0; x < stride_; ++x) {
      here += own[x];
      own[x] = sum;
      sum += here;
    }
  }
  work_ += static_cast<std::int64_t>(table_.size() / 2);
}

std::int64_t OverlapTable::overlap(const Mask& mask, int x, int y, std::int64_t most) {
  const int left = x - mask.margin - window_.x_begin, low = y - mask.margin;
  std::int64_t sum = 0;
  int k = 0;
  for (; k < mask.grown.height() && sum < most; ++k) {
    const std::int32_t* own = row(low + k) + left;
    for (const Run& run : mask.grown.row(k)) sum += own[run.end] - own[run.begin];
  }
  work_ += k + kWorkOfALook;
  return sum < most ? sum : kTooMuch;
}

}  // namespace unwrapd
