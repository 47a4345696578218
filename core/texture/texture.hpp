#pragma once
// A decoded image that is read at texture coordinates, as a renderer of glTF reads it.

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/texture/image.hpp"

namespace unwrapd::texture {

enum class Wrap { repeat, mirror, clamp };

/// How a sampler of glTF reads: beyond [0, 1], and between texels.
struct Sampling {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool is_nearest = false;  ///< else linear

  bool operator==(const Sampling&) const = default;
};

/// Four channels in [0, 1], linear in light where the image is sRGB.
using Texel = std::array<float, 4>;

class Texture {
 public:
  /// is_srgb: red, green and blue are stored in sRGB; alpha never is. Throws Error{cancelled}.
  Texture(Image image, bool is_srgb, const std::stop_token& stop);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }
  [[nodiscard]] bool is_deep() const { return levels_.front().is_deep(); }
  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }

  /// uv: V pointing down, finite. level: of the mip chain, 0 is the image.
  [[nodiscard]] Texel sample(const Vec2& uv, int level, const Sampling& sampling) const;

 private:
  [[nodiscard]] Texel texel(const Image& image, int x, int y) const;
  struct Range {
    int begin, end;
  };
  [[nodiscard]] Texel mean_of(const Image& image, Range columns, Range rows) const;
  [[nodiscard]] Image halved(const Image& image, const std::stop_token& stop) const;

  std::vector<Image> levels_;
  bool is_srgb_;
};

/// Stores a texel in the image whose first value has this index. is_srgb: as of Texture.
void store(Image& image, std::size_t index, const Texel& texel, bool is_srgb);

}  // namespace unwrapd::texture
