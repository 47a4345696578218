#pragma once
// Remembers where islands of one size last found a place: the rows below had none for that size.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/pack/mask.hpp"

namespace unwrapd::pack {

struct Cell {
  int x = 0, y = 0;
};

class PlacementHints {
 public:
  Cell& of(const Mask& mask) {
    return places_[class_of(mask.width)][class_of(mask.touched.height())];
  }

 private:
  static constexpr std::size_t kClasses = 60;  // of widths and of heights, four to a doubling

  static std::size_t class_of(int cells) {
    return std::min(kClasses - 1, static_cast<std::size_t>(4 * std::log2(cells + 1.0)));
  }

  std::array<std::array<Cell, kClasses>, kClasses> places_{};
};

}  // namespace unwrapd::pack
