#include "core/figure/bands.hpp"

#include <algorithm>

namespace unwrapd {

void Band::start(int first) {
  first_ = first;
  std::ranges::fill(colour_, background_);
  std::ranges::fill(depth_, -std::numeric_limits<float>::infinity());
}

void Band::fill(const ScreenTriangle& triangle, const Rgb& colour) {
  scan(triangle, rows(), columns_, [&](int row, const SampleRange& range) {
    const auto at = colour_.begin() + static_cast<std::ptrdiff_t>(place(row, range.first));
    std::fill(at, at + (range.end - range.first), colour);
  });
}

void Band::resolve(Image& image) const {
  constexpr unsigned kCount = kSamples * kSamples;
  const int top = first_ / kSamples, bottom = std::min(top + kPixels, image.height);
  std::size_t out = 3 * static_cast<std::size_t>(top) * static_cast<std::size_t>(image.width);
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::array<unsigned, 3> sum = {kCount / 2, kCount / 2, kCount / 2};  // to round
      for (int row = 0; row < kSamples; ++row) {
        const std::size_t at = place(y * kSamples + row, x * kSamples);
        for (std::size_t k = at; k < at + kSamples; ++k)
          for (std::size_t part = 0; part < 3; ++part) sum[part] += colour_[k][part];
      }
      for (const unsigned part : sum) image.rgb[out++] = static_cast<std::uint8_t>(part / kCount);
    }
  }
}

}  // namespace unwrapd
