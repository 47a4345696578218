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
  std::ranges::fill(painted_, std::uint8_t{0});
}

void Band::fill(const ScreenTriangle& triangle, const Rgb& colour) {
  scan(triangle, rows(), columns_, [&](int row, const SampleRange& range) {
    const auto first = static_cast<std::ptrdiff_t>(place(row, range.first));
    std::fill_n(colour_.begin() + first, range.end - range.first, colour);
    if (!painted_.empty())
      std::fill_n(painted_.begin() + first, range.end - range.first, std::uint8_t{1});
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

std::array<std::uint8_t, 4> Band::painted_mean(std::size_t first) const {
  std::array<unsigned, 3> sum{};
  unsigned count = 0;
  for (std::size_t row = 0; row < kSamples; ++row, first += static_cast<std::size_t>(columns_)) {
    for (std::size_t k = first; k < first + kSamples; ++k) {
      if (painted_[k] == 0) continue;
      ++count;
      for (std::size_t part = 0; part < 3; ++part) sum[part] += colour_[k][part];
    }
  }
  if (count == 0) return {};
  const auto part = [&](std::size_t k) {
    return static_cast<std::uint8_t>((sum[k] + count / 2) / count);
  };
  const auto alpha = static_cast<std::uint8_t>((255 * count + kSampleCount / 2) / kSampleCount);
  return {part(0), part(1), part(2), alpha};
}

void Band::resolve(Image& image) const {
  const int top = first_ / kSamples, bottom = std::min(top + kPixels, image.height);
  std::size_t out = static_cast<std::size_t>(top) * static_cast<std::size_t>(image.width);
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < image.width; ++x, ++out) {
      const std::size_t first = place(y * kSamples, x * kSamples);
      if (painted_.empty()) {
        std::ranges::copy(mean(first), image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * out));
        continue;
      }
      const auto [red, green, blue, alpha] = painted_mean(first);
      std::ranges::copy(Rgb{red, green, blue},
                        image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * out));
      image.alpha[out] = alpha;
    }
  }
}

}  // namespace unwrapd::figure
