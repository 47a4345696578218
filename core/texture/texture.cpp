// Averages are taken in linear light, since renderers decode sRGB before they filter.
#include "core/texture/texture.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/srgb.hpp"

namespace unwrapd::texture {
namespace {

/// [i]: the value of which i is stored, in `count` steps.
std::vector<float> table(std::size_t count, bool is_srgb) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = static_cast<double>(i) / static_cast<double>(count - 1);
    values[i] = static_cast<float>(is_srgb ? from_srgb(value) : value);
  }
  return values;
}

const float* decoded(bool is_srgb) {
  static const std::vector<float> plain = table(256, false), srgb = table(256, true);
  return (is_srgb ? srgb : plain).data();
}

const float* decoded_deep(bool is_srgb) {
  static const std::vector<float> plain = table(65'536, false), srgb = table(65'536, true);
  return (is_srgb ? srgb : plain).data();
}

/// [i]: where the stored value i ends and i + 1 begins.
const std::array<float, 255>& srgb_bounds() {
  static const std::array<float, 255> bounds = [] {
    std::array<float, 255> made{};
    for (std::size_t i = 0; i < made.size(); ++i)
      made[i] = static_cast<float>(from_srgb((static_cast<double>(i) + 0.5) / 255));
    return made;
  }();
  return bounds;
}

/// The coordinate within the image, or its mirror image.
double within(double u, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp(u, 0.0, 1.0);
  return wrap == Wrap::repeat ? u - std::floor(u) : u - 2 * std::floor(u / 2);
}

/// The texel for a number up to one beyond what within() leads to.
int wrapped(int i, int count, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp(i, 0, count - 1);
  const int period = wrap == Wrap::repeat ? count : 2 * count;
  const int k = i < 0 ? i + period : i >= period ? i - period : i;
  return k < count ? k : 2 * count - 1 - k;
}

/// Two texels along one axis, and the weight of the second.
struct Taps {
  int first = 0, second = 0;
  float weight = 0;
};

Taps taps(double u, int count, Wrap wrap, bool is_nearest) {
  const double at = within(u, wrap) * count;
  if (is_nearest) return {wrapped(static_cast<int>(at), count, wrap), 0, 0};  // at >= 0
  const int i = static_cast<int>(at + 0.5) - 1;  // at - 0.5, rounded down
  return {wrapped(i, count, wrap), wrapped(i + 1, count, wrap), static_cast<float>(at - 0.5 - i)};
}

Texel mixed(const Texel& a, const Texel& b, float weight) {
  Texel mix;
  for (std::size_t c = 0; c < 4; ++c) mix[c] = a[c] + weight * (b[c] - a[c]);
  return mix;
}

/// The stored value of a channel in [0, 1]; of sRGB, of a value linear in light.
std::uint8_t stored(float value, bool is_srgb) {
  if (!is_srgb) return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
  const auto& bounds = srgb_bounds();
  return static_cast<std::uint8_t>(std::upper_bound(bounds.begin(), bounds.end(), value) -
                                   bounds.begin());
}

std::uint16_t stored_deep(float value, bool is_srgb) {
  const double clamped = std::clamp(static_cast<double>(value), 0.0, 1.0);
  return static_cast<std::uint16_t>(std::lround(65'535 * (is_srgb ? to_srgb(clamped) : clamped)));
}

}  // namespace

void store(Image& image, std::size_t index, const Texel& texel, bool is_srgb) {
  for (std::size_t c = 0; c < 4; ++c) {
    const bool is_colour = is_srgb && c < 3;
    if (image.is_deep())
      image.deep[index + c] = stored_deep(texel[c], is_colour);
    else
      image.rgba[index + c] = stored(texel[c], is_colour);
  }
}

Texture::Texture(Image image, bool is_srgb, const std::stop_token& stop) : is_srgb_(is_srgb) {
  assert(image.width > 0 && image.height > 0);
  levels_.push_back(std::move(image));
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(halved(levels_.back(), stop));
}

Texel Texture::texel(const Image& image, int x, int y) const {
  const auto read = [&](const auto* values, const float* colour, const float* alpha) -> Texel {
    return {colour[values[0]], colour[values[1]], colour[values[2]], alpha[values[3]]};
  };
  const std::size_t index = image.index(x, y);
  return image.is_deep()
             ? read(image.deep.data() + index, decoded_deep(is_srgb_), decoded_deep(false))
             : read(image.rgba.data() + index, decoded(is_srgb_), decoded(false));
}

/// Each texel is the mean of four; the last of a row or column takes in an odd one, too.
Image Texture::halved(const Image& image, const std::stop_token& stop) const {
  Image half =
      blank_image({std::max(image.width / 2, 1), std::max(image.height / 2, 1)}, image.is_deep());
  for (int y = 0; y < half.height; ++y) {
    throw_if_cancelled(stop);
    const int rows_end = y + 1 == half.height ? image.height : 2 * y + 2;
    for (int x = 0; x < half.width; ++x) {
      const int columns_end = x + 1 == half.width ? image.width : 2 * x + 2;
      store(half, half.index(x, y), mean_of(image, {2 * x, columns_end}, {2 * y, rows_end}),
            is_srgb_);
    }
  }
  return half;
}

Texel Texture::mean_of(const Image& image, Range columns, Range rows) const {
  Texel sum{};
  for (int y = rows.begin; y < rows.end; ++y)
    for (int x = columns.begin; x < columns.end; ++x) {
      const Texel one = texel(image, x, y);
      for (std::size_t c = 0; c < 4; ++c) sum[c] += one[c];
    }
  const auto count = static_cast<float>((columns.end - columns.begin) * (rows.end - rows.begin));
  for (float& channel : sum) channel /= count;
  return sum;
}

Texel Texture::sample(const Vec2& uv, int level, const Sampling& sampling) const {
  assert(uv.allFinite() && level >= 0 && level < levels());
  const Image& image = levels_[static_cast<std::size_t>(level)];
  const Taps x = taps(uv.x(), image.width, sampling.wrap_u, sampling.is_nearest);
  const Taps y = taps(uv.y(), image.height, sampling.wrap_v, sampling.is_nearest);
  if (sampling.is_nearest) return texel(image, x.first, y.first);
  return mixed(mixed(texel(image, x.first, y.first), texel(image, x.second, y.first), x.weight),
               mixed(texel(image, x.first, y.second), texel(image, x.second, y.second), x.weight),
               y.weight);
}

}  // namespace unwrapd::texture
