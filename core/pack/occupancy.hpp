#pragma once
// The taken cells of a page, in a form that tests all places of a row at once.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/pack/mask.hpp"

namespace unwrapd::pack {

class Occupancy {
 public:
  /// width, height: cells of the free page. Islands keep their margin from each other, not from the
  /// edge of the page. margin: of all masks; longest_run: upper bound of their grown rows.
  Occupancy(int width, int height, int margin, int longest_run);

  /// The leftmost x >= from at which the mask's lower left cell may lie on (x, y), so that all
  /// touched cells lie on the page. Empty if the row has no such place.
  [[nodiscard]] std::optional<int> first_free(const Mask& mask, int y, int from = 0);

  /// Whether a cell is taken. Cells beyond the page's sides and bottom are; cells above it are not.
  [[nodiscard]] bool is_taken(int x, int y) const;

  /// Marks the touched cells as taken.
  void stamp(const Mask& mask, int x, int y);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::int64_t work() const { return work_; }  ///< words read so far

 private:
  using Word = std::uint64_t;
  /// A row of the page and the first word to read in it.
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
  /// [word / words at once]: the rows of the page that last refused all places there, the latest
  /// first. They are tested first next time. On narrow pages one: more gain nothing there.
  std::vector<std::vector<int>> refusing_rows_;
  std::vector<Word> bits_;  // bit x of row(k, y): a cell of [x, x + 2^k) is taken
};

}  // namespace unwrapd::pack
