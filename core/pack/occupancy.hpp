#pragma once
// Which cells of a page are taken, in a form that answers "where in this row does it fit?" for all
// places of the row at once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/pack/mask.hpp"

namespace unwrapd::pack {

class Occupancy {
 public:
  /// width, height: cells of the free page; islands keep their margin from each other, not from its
  /// edge. margin: of all masks; longest_run: of their grown rows, at most.
  Occupancy(int width, int height, int margin, int longest_run);

  /// The leftmost x, from `from` on, at which the mask's lower left cell may lie on (x, y); touched
  /// cells stay on the page. Nothing when the row has no such place.
  [[nodiscard]] std::optional<int> first_free(const Mask& mask, int y, int from = 0);

  /// Whether a cell is taken, as those beyond the page's sides and bottom are; above it none is.
  [[nodiscard]] bool is_taken(int x, int y) const;

  /// Takes the touched cells.
  void stamp(const Mask& mask, int x, int y);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::int64_t work() const { return work_; }  ///< words looked at so far

 private:
  using Word = std::uint64_t;
  /// A row of the page and the first of its words that are looked at.
  struct Place {
    int y = 0;
    std::size_t word = 0;
  };

  [[nodiscard]] Word* row(int level, int y);
  [[nodiscard]] const Word* row(int level, int y) const;
  template <std::size_t Words>
  void refuse(const Rows& grown, int mask_row, const Place& place, std::span<Word> refused);
  template <std::size_t Words>
  std::optional<int> first_free_in(const Mask& mask, const Place& place, std::span<Word> refused);
  std::optional<int> search(const Mask& mask, const Place& place, std::span<Word> refused);
  void spread(int y, int begin, int end);

  int width_, height_, margin_, levels_ = 1;
  std::size_t words_;
  std::int64_t work_ = 0;
  int refusing_row_ = 0;    // of the page: the last that left no place; it comes first next time
  std::vector<Word> bits_;  // bit x of row(k, y): a cell of [x, x + 2^k) is taken
};

}  // namespace unwrapd::pack
