#pragma once
// An island as cells of a square grid: the cells that it touches, and those too near to it for
// others.

#include <span>
#include <vector>

#include "core/charts/outline.hpp"

namespace unwrapd::pack {

/// A row's cells [begin, end).
struct Run {
  int begin = 0;
  int end = 0;
};

/// Row y's runs are runs[first[y]] .. runs[first[y + 1] - 1], ascending, with gaps between them.
struct Rows {
  std::vector<Run> runs;
  std::vector<int> first{0};

  [[nodiscard]] int height() const { return static_cast<int>(first.size()) - 1; }
  [[nodiscard]] std::span<const Run> row(int y) const {
    const auto begin = static_cast<std::size_t>(first[static_cast<std::size_t>(y)]);
    const auto end = static_cast<std::size_t>(first[static_cast<std::size_t>(y) + 1]);
    return std::span(runs).subspan(begin, end - begin);
  }
};

/// The rotation and scale of an island on the grid: uv_grid = scale * (rotation * uv), before the
/// translation to a cell.
struct Turn {
  double cosine = 1;
  double sine = 0;
  double scale = 1;

  [[nodiscard]] Vec2 operator()(const Vec2& uv) const {
    return scale * Vec2(cosine * uv.x() - sine * uv.y(), sine * uv.x() + cosine * uv.y());
  }
};

struct Mask {
  Vec2 low = Vec2::Zero();  ///< the rotated island's lower left corner, which goes to (0, 0)
  int width = 0;
  int margin = 0;    ///< cells by which grown reaches beyond touched on every side
  double cells = 0;  ///< number of touched cells
  Rows touched;      ///< cells that the island's closure touches; holes stay free
  /// Touched cells and all cells nearer than the padding to one; cell (x, y) of the island is (x +
  /// margin, y + margin) here.
  Rows grown;
};

/// How far a padding (cells, >= 0) reaches, in whole cells.
int margin_of(double padding);

/// padding: cells, >= 0. Two islands are at least that far apart if the grown cells of one and the
/// touched cells of the other are disjoint. Points whose winding number is not zero are inside.
Mask make_mask(const charts::Outline& outline, const Turn& turn, double padding);

}  // namespace unwrapd::pack
