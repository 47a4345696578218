// Finds a nearest covered texel for all others in two sweeps over the image, each of which hands
// offsets on to neighbours: P.-E. Danielsson, Euclidean Distance Mapping, 1980. A few texels get
// one that is a fraction of a texel farther than the nearest.
#include <array>
#include <cstdlib>

#include "core/base/cancel.hpp"
#include "core/texture/resample.hpp"

namespace unwrapd::texture {
namespace {

/// From a texel to the covered one that it takes its colour from.
struct Offset {
  std::int16_t x = kNone, y = kNone;

  static constexpr std::int16_t kNone = INT16_MAX;
};

std::int64_t squared_length(std::int64_t x, std::int64_t y) { return x * x + y * y; }

class Sweeper {
 public:
  Sweeper(Painted& painted, const std::stop_token& stop)
      : painted_(painted), width_(painted.image.width), height_(painted.image.height), stop_(stop) {
    offsets_.resize(painted.is_covered.size());
    for (std::size_t i = 0; i < offsets_.size(); ++i)
      if (painted.is_covered[i] != 0) offsets_[i] = {0, 0};
  }

  void run() {
    for (int y = 0; y < height_; ++y) sweep_row(y, -1);
    for (int y = height_ - 1; y >= 0; --y) sweep_row(y, 1);
    for (int y = 0; y < height_; ++y) fill_row(y);
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  /// Takes the neighbour's offset where it is shorter.
  void compare(int x, int y, int dx, int dy) {
    if (x + dx < 0 || x + dx >= width_ || y + dy < 0 || y + dy >= height_) return;
    const Offset& other = offsets_[index(x + dx, y + dy)];
    if (other.x == Offset::kNone) return;
    Offset& own = offsets_[index(x, y)];
    const int nx = other.x + dx, ny = other.y + dy;
    if (own.x == Offset::kNone || squared_length(nx, ny) < squared_length(own.x, own.y))
      own = {static_cast<std::int16_t>(nx), static_cast<std::int16_t>(ny)};
  }

  /// from: the row that has been done, above (-1) or below (1).
  void sweep_row(int y, int from) {
    throw_if_cancelled(stop_);
    for (int x = 0; x < width_; ++x) {
      for (int dx = -1; dx <= 1; ++dx) compare(x, y, dx, from);
      compare(x, y, -1, 0);
    }
    for (int x = width_ - 1; x >= 0; --x) compare(x, y, 1, 0);
  }

  void fill_row(int y) {
    throw_if_cancelled(stop_);
    for (int x = 0; x < width_; ++x) {
      const Offset& offset = offsets_[index(x, y)];
      if (offset.x == Offset::kNone) return;  // nothing is covered
      const std::size_t from = painted_.image.index(x + offset.x, y + offset.y);
      const std::size_t to = painted_.image.index(x, y);
      const auto copy = [&](auto* values) { std::copy_n(values + from, 4, values + to); };
      if (painted_.image.is_deep())
        copy(painted_.image.deep.data());
      else
        copy(painted_.image.rgba.data());
    }
  }

  Painted& painted_;
  int width_, height_;
  const std::stop_token& stop_;
  std::vector<Offset> offsets_;
};

}  // namespace

void dilate(Painted& painted, const std::stop_token& stop) { Sweeper(painted, stop).run(); }

}  // namespace unwrapd::texture
