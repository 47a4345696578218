#pragma once
// A picture made band by band: only one band's samples are in memory, whatever the size, and each
// band looks only at what touches it.

#include <cstdint>
#include <limits>
#include <stop_token>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/figure/image.hpp"
#include "core/figure/scan.hpp"
#include "core/mesh/counting_sort.hpp"

namespace unwrapd::figure {

/// The samples of some rows of pixels.
class Band {
 public:
  static constexpr int kPixels = 16;  ///< its height
  static constexpr int kRows = kPixels * kSamples;

  /// is_clear: what nothing is painted on is transparent; it remembers what was.
  Band(int width, const Rgb& background, bool is_clear)
      : columns_(width * kSamples),
        background_(background),
        colour_(size()),
        depth_(size()),
        painted_(is_clear ? size() : 0) {}

  /// Moves to the rows from `first` on, empty.
  void start(int first);

  [[nodiscard]] SampleRange rows() const { return {first_, first_ + kRows}; }
  [[nodiscard]] int columns() const { return columns_; }

  /// Paints over what is there.
  void fill(const ScreenTriangle& triangle, const Rgb& colour);

  /// The place of a sample of this band, for colour_at() and is_nearer().
  [[nodiscard]] std::size_t place(int row, int column) const {
    return static_cast<std::size_t>(row - first_) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  /// Whether nothing as near has been there; if so, it has now. Nearer is greater.
  bool take_nearer(std::size_t place, float depth) {
    if (!(depth > depth_[place])) return false;
    depth_[place] = depth;
    return true;
  }
  Rgb& colour_at(std::size_t place) { return colour_[place]; }

  /// Writes the means of the samples into the picture's rows; where it has alpha, of those that
  /// were painted.
  void resolve(Image& image) const;

 private:
  /// Of the pixel whose first sample is at this place.
  [[nodiscard]] Rgb mean(std::size_t first) const;
  /// The same of its painted samples, and their share as alpha.
  [[nodiscard]] std::array<std::uint8_t, 4> painted_mean(std::size_t first) const;
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(kRows) * static_cast<std::size_t>(columns_);
  }

  int first_ = 0;
  int columns_;
  Rgb background_;
  std::vector<Rgb> colour_;
  std::vector<float> depth_;
  std::vector<std::uint8_t> painted_;  // empty unless is_clear
};

/// What a picture is drawn on.
struct Canvas {
  Image& image;
  Rgb background;  ///< of an image without alpha
  std::stop_token stop = {};
};

/// Draws `count` things in their order: triangle(k) tells where thing k is, draw(k, band) draws
/// what of it lies in a band. Throws Error{cancelled} once a stop was requested.
template <class TriangleOf, class Draw>
void draw_in_bands(const Canvas& canvas, Index count, TriangleOf triangle, Draw draw) {
  Image& image = canvas.image;
  struct Touch {
    Index band = 0;
    Index thing = 0;
  };
  const Index bands = (image.height + Band::kPixels - 1) / Band::kPixels;
  std::vector<Touch> touches;
  for (Index k = 0; k < count; ++k) {
    check_cancelled_every(k, canvas.stop);
    const SampleRange rows = rows_of(triangle(k));
    const Index first = std::max(0, rows.first) / Band::kRows;
    for (Index b = first; b < bands && b * Band::kRows < rows.end; ++b) touches.push_back({b, k});
  }
  counting_sort(touches, bands, [](const Touch& touch) { return touch.band; });
  Band band(image.width, canvas.background, !image.alpha.empty());
  std::size_t next = 0;
  for (Index b = 0; b < bands; ++b) {
    throw_if_cancelled(canvas.stop);
    band.start(b * Band::kRows);
    for (; next < touches.size() && touches[next].band == b; ++next) {
      check_cancelled_every(next, canvas.stop);
      draw(touches[next].thing, band);
    }
    band.resolve(image);
  }
}

}  // namespace unwrapd::figure
