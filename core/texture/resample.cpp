// The page is painted in bands of rows, so that sums of floats are held for one band alone. Within
// a band triangles come in their order: the result depends on nothing else.
#include "core/texture/resample.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/cancel.hpp"
#include "core/texture/affine.hpp"

namespace unwrapd::texture {
namespace {

constexpr int kBandRows = 64;
constexpr int kMostSamples = 8;         // of a texel, along an axis
constexpr std::size_t kPause = 65'536;  // samples between two looks at the stop

/// Sums of samples of one texel.
struct Sum {
  Texel value{};
  float weight = 0;
};

/// How a triangle is sampled: `across` x `down` samples in a texel, at a level of the mip chain.
struct Grid {
  int across = 1, down = 1, level = 0;
};

Grid grid_of(const Affine& map, const Texture& texture) {
  const auto texels = [&](int axis) {
    const Vec2 step = map.linear.col(axis);
    return std::hypot(step.x() * texture.width(), step.y() * texture.height());
  };
  double across = texels(0), down = texels(1);
  Grid grid;
  for (; std::max(across, down) > kMostSamples && grid.level + 1 < texture.levels(); ++grid.level)
    across /= 2, down /= 2;
  const auto count = [](double under) {
    return static_cast<int>(std::clamp(std::ceil(under), 1.0, double{kMostSamples}));
  };
  grid.across = count(across);
  grid.down = count(down);
  return grid;
}

/// Where a horizontal line lies in a triangle: from low to before high; empty if they are equal.
/// Both triangles of an edge get the same number for it, so that a point belongs to one of them.
struct Interval {
  double low = 0, high = 0;
};

Interval interval_at(const std::array<Vec2, 3>& corners, double y) {
  std::array<double, 3> crossings{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec2 a = corners[k], b = corners[(k + 1) % 3];
    if (a.y() > b.y()) std::swap(a, b);
    if (y < a.y() || y >= b.y()) continue;
    crossings[count++] = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
  }
  if (count < 2) return {};
  return {std::min(crossings[0], crossings[1]), std::max(crossings[0], crossings[1])};
}

/// A vector of the old tangent frame in the new one: (x, y, z) for the tangent, bitangent and
/// normal that renderers interpolate.
Eigen::Vector3f turned(const Eigen::Vector3f& vector, const TurnedFrames& frames,
                       const Eigen::Vector3f& weights) {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero(), from = normal, to = normal;
  for (int k = 0; k < 3; ++k) {
    const TurnedFrames::Corner& corner = frames.corner[static_cast<std::size_t>(k)];
    normal += weights[k] * corner.normal;
    from += weights[k] * corner.from;
    to += weights[k] * corner.to;
  }
  const Eigen::Vector3f world =
      vector.x() * from + vector.z() * normal + vector.y() * frames.from_sign * normal.cross(from);
  const Eigen::Vector3f bitangent = frames.to_sign * normal.cross(to);
  const float volume = to.dot(bitangent.cross(normal));
  if (!(std::abs(volume) > 1e-6F)) return vector;
  return Eigen::Vector3f(world.dot(bitangent.cross(normal)), world.dot(normal.cross(to)),
                         world.dot(to.cross(bitangent))) /
         volume;
}

Texel turned_texel(const Texel& texel, const TurnedFrames& frames, const Eigen::Vector3f& weights,
                   Content content) {
  const bool is_normal = content == Content::normals;
  const Eigen::Vector3f old(2 * texel[0] - 1, 2 * texel[1] - 1, is_normal ? 2 * texel[2] - 1 : 0);
  const Eigen::Vector3f now = turned(old, frames, weights).stableNormalized();
  return {now.x(), now.y(), is_normal ? now.z() : texel[2], texel[3]};
}

/// The texel from the mean of its samples.
Texel finished(Texel mean, Content content) {
  if (content == Content::normals || content == Content::directions) {
    const bool is_normal = content == Content::normals;
    const Eigen::Vector3f unit =
        Eigen::Vector3f(mean[0], mean[1], is_normal ? mean[2] : 0).stableNormalized();
    for (int c = 0; c < (is_normal ? 3 : 2); ++c)
      mean[static_cast<std::size_t>(c)] = (unit[c] + 1) / 2;
  }
  return mean;
}

/// A triangle by the numbers of its patch and in it.
struct TriangleId {
  std::uint32_t patch = 0, triangle = 0;
};

/// The first and last row of samples of a triangle that may lie in the page; empty if first > last.
struct Rows {
  int first = 0, last = -1;
};

Rows rows_of(const PlacedTriangle& triangle, int height) {
  const auto [low, high] =
      std::minmax({triangle.to[0].y(), triangle.to[1].y(), triangle.to[2].y()});
  if (!(low <= 1 && high >= 0)) return {};
  const auto row = [&](float v) {
    return static_cast<int>(std::clamp(std::floor(double{v} * height), 0.0, height - 1.0));
  };
  return {row(low), row(high)};
}

class Painter {
 public:
  Painter(const Texture& texture, std::span<const Patch> patches, const Size& size, Content content,
          const std::stop_token& stop)
      : texture_(texture), patches_(patches), size_(size), content_(content), stop_(stop) {
    painted_.image = blank_image(size, texture.is_deep());
    painted_.is_covered.resize(row_texels() * static_cast<std::size_t>(size.height));
    sort_into_bands();
  }

  Painted run() {
    for (std::size_t band = 0; band < bands_.size(); ++band) {
      throw_if_cancelled(stop_);
      first_row_ = static_cast<int>(band) * kBandRows;
      end_row_ = std::min(first_row_ + kBandRows, size_.height);
      sums_.assign(static_cast<std::size_t>(end_row_ - first_row_) * row_texels(), {});
      for (const TriangleId& id : bands_[band]) add(id);
      finish_band();
    }
    return std::move(painted_);
  }

 private:
  [[nodiscard]] std::size_t row_texels() const { return static_cast<std::size_t>(size_.width); }

  void sort_into_bands() {
    bands_.resize(static_cast<std::size_t>((size_.height + kBandRows - 1) / kBandRows));
    for (std::uint32_t p = 0; p < patches_.size(); ++p)
      for (std::uint32_t t = 0; t < patches_[p].triangles.size(); ++t) {
        check_cancelled_every(t, stop_);
        const Rows rows = rows_of(patches_[p].triangles[t], size_.height);
        for (int b = rows.first / kBandRows; rows.last >= 0 && b <= rows.last / kBandRows; ++b)
          bands_[static_cast<std::size_t>(b)].push_back({p, t});
      }
  }

  /// Adds the samples of a triangle in this band.
  void add(const TriangleId& id) {
    const Patch& patch = patches_[id.patch];
    const PlacedTriangle& triangle = patch.triangles[id.triangle];
    const std::optional<Affine> map = affine_of(triangle, size_);
    if (!map) return;
    const Grid grid = grid_of(*map, texture_);
    const TurnedFrames* frames = patch.frames.empty() ? nullptr : &patch.frames[id.triangle];
    std::array<Vec2, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = in_texels(triangle.to[k], size_);
    const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
    const double first = std::max(low, double(first_row_)), end = std::min(high, double(end_row_));
    const auto line_at = [&](double y) { return static_cast<int>(std::ceil(y * grid.down - 0.5)); };
    const int last_line = std::min(line_at(end), end_row_ * grid.down - 1);
    for (int line = std::max(line_at(first), first_row_ * grid.down); line <= last_line; ++line) {
      const double y = (line + 0.5) / grid.down;
      const Interval interval = interval_at(corners, y);
      const auto column_at = [&](double x) {  // the first at x or beyond
        return static_cast<int>(
            std::ceil(std::clamp(x, 0.0, double(size_.width)) * grid.across - 0.5));
      };
      const int end_column = std::min(column_at(interval.high), size_.width * grid.across);
      for (int i = column_at(interval.low); i < end_column; ++i)
        add_sample(Vec2((i + 0.5) / grid.across, y), *map, grid, patch.sampling, frames);
    }
  }

  void add_sample(const Vec2& at, const Affine& map, const Grid& grid, const Sampling& sampling,
                  const TurnedFrames* frames) {
    if (++samples_ % kPause == 0) throw_if_cancelled(stop_);
    const Vec2 offset = at - map.origin;
    Texel texel = texture_.sample(map.start + map.linear * offset, grid.level, sampling);
    if (frames != nullptr) {
      const Eigen::Vector2f far = (map.barycentric * offset).cast<float>();
      texel = turned_texel(texel, *frames, {1 - far.x() - far.y(), far.x(), far.y()}, content_);
    }
    Sum& sum =
        sums_[static_cast<std::size_t>(static_cast<int>(at.y()) - first_row_) * row_texels() +
              static_cast<std::size_t>(at.x())];
    const float weight = 1 / static_cast<float>(grid.across * grid.down);
    for (std::size_t c = 0; c < 4; ++c) sum.value[c] += weight * texel[c];
    sum.weight += weight;
  }

  void finish_band() {
    const std::size_t first = static_cast<std::size_t>(first_row_) * row_texels();
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      Sum& sum = sums_[i];
      if (sum.weight == 0) continue;
      for (float& value : sum.value) value /= sum.weight;
      store(painted_.image, 4 * (first + i), finished(sum.value, content_),
            content_ == Content::colour);
      painted_.is_covered[first + i] = 1;
    }
  }

  const Texture& texture_;
  std::span<const Patch> patches_;
  Size size_;
  Content content_;
  const std::stop_token& stop_;
  Painted painted_;
  std::vector<std::vector<TriangleId>> bands_;
  std::vector<Sum> sums_;  ///< of the texels of one band
  int first_row_ = 0, end_row_ = 0;
  std::size_t samples_ = 0;
};

}  // namespace

Painted resample(const Texture& texture, std::span<const Patch> patches, const Size& size,
                 Content content, const std::stop_token& stop) {
  assert(std::min(size.width, size.height) > 0 && std::max(size.width, size.height) <= kMaxSide);
  return Painter(texture, patches, size, content, stop).run();
}

}  // namespace unwrapd::texture
