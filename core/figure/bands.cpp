#include "core/figure/bands.hpp"

#include <algorithm>

namespace unwrapd::figure {
namespace {

constexpr unsigned kSampleCount = kSamples * kSamples;  // of a pixel

}  // namespace

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

Rgb Band::mean(std::size_t first) const {
  std::array<unsigned, 3> sum = {kSampleCount / 2, kSampleCount / 2, kSampleCount / 2};  // to round
  for (std::size_t row = 0; row < kSamples; ++row, first += static_cast<std::size_t>(columns_)) {
    for (std::size_t k = first; k < first + kSamples; ++k)
      for (std::size_t part = 0; part < 3; ++part) sum[part] += colour_[k][part];
  }
  const auto divided = [](unsigned part) { return static_cast<std::uint8_t>(part / kSampleCount); };
  return {divided(sum[0]), divided(sum[1]), divided(sum[2])};
}

void Band::resolve(Image& image) const {
  const int top = first_ / kSamples, bottom = std::min(top + kPixels, image.height);
  std::size_t out = 3 * static_cast<std::size_t>(top) * static_cast<std::size_t>(image.width);
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < image.width; ++x)
      for (const std::uint8_t part : mean(place(y * kSamples, x * kSamples)))
        image.rgb[out++] = part;
  }
}

}  // namespace unwrapd::figure
