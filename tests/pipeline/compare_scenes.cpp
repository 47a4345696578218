#include <cmath>
#include <limits>

#include "tests/pipeline/textured_scene.hpp"

namespace unwrapd::test {
namespace {

constexpr int kSamples = 4;  // of a pixel, along an axis

double to_srgb(double x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

/// A scene's faces on the screen.
struct Screen {
  Vec3 right, up, toward, middle;
  double scale = 1;
  int size = 0;

  [[nodiscard]] Vec3 of(const Vec3& p) const {
    const Vec3 d = p - middle;
    return {size / 2.0 + scale * d.dot(right), size / 2.0 - scale * d.dot(up), d.dot(toward)};
  }
};

Screen screen_of(const TexturedScene& scene, const Vec3& direction, int size) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const SceneFace& face : scene.faces())
    for (const SceneCorner& corner : face.corner) {
      low = low.cwiseMin(corner.position);
      high = high.cwiseMax(corner.position);
    }
  Screen screen;
  screen.toward = direction.normalized();
  screen.right = Vec3(0, 1, 0).cross(screen.toward).normalized();
  screen.up = screen.toward.cross(screen.right);
  screen.middle = (low + high) / 2;
  screen.scale = 0.95 * size / (high - low).norm();
  screen.size = size;
  return screen;
}

struct Hit {
  int face = -1;
  Vec3 weights = Vec3::Zero();
  double depth = -std::numeric_limits<double>::infinity();
};

/// [sample]: the nearest face there, seen from its front.
std::vector<Hit> hits_of(const TexturedScene& scene, const Screen& screen) {
  const int n = screen.size * kSamples;
  std::vector<Hit> hits(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (std::size_t f = 0; f < scene.faces().size(); ++f) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = screen.of(scene.faces()[f].corner[k].position);
    const auto cross = [](const Vec3& a, const Vec3& b, double x, double y) {
      return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
    };
    const double area = cross(p[0], p[1], p[2].x(), p[2].y());
    if (!(area < 0)) continue;  // y points down
    const auto bound = [&](int axis, bool is_high) {
      const auto [lo, hi] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
      return std::clamp(static_cast<int>((is_high ? hi : lo) * kSamples), 0, n - 1);
    };
    for (int y = bound(1, false); y <= bound(1, true); ++y)
      for (int x = bound(0, false); x <= bound(0, true); ++x) {
        const double px = (x + 0.5) / kSamples, py = (y + 0.5) / kSamples;
        const Vec3 w =
            Vec3(cross(p[1], p[2], px, py), cross(p[2], p[0], px, py), cross(p[0], p[1], px, py)) /
            area;
        const double depth = w.x() * p[0].z() + w.y() * p[1].z() + w.z() * p[2].z();
        Hit& hit = hits[static_cast<std::size_t>(y) * static_cast<std::size_t>(n) +
                        static_cast<std::size_t>(x)];
        if (w.minCoeff() >= 0 && depth > hit.depth) hit = {static_cast<int>(f), w, depth};
      }
  }
  return hits;
}

/// The colour of a pixel in [0, 255]: the mean over its samples; white where there is nothing.
Vec3 pixel_of(const TexturedScene& scene, const std::vector<const Hit*>& hits, Look look) {
  Vec3 sum = Vec3::Zero();
  for (const Hit* hit : hits)
    sum += hit->face < 0 ? Vec3(1, 1, 1)
                         : scene.look(static_cast<std::size_t>(hit->face), hit->weights, look);
  sum /= static_cast<double>(hits.size());
  for (int c = 0; c < 3; ++c)
    sum[c] = 255 * (look == Look::normals ? (sum[c] + 1) / 2 : to_srgb(sum[c]));
  return sum;
}

/// Compares pixel by pixel.
class Comparison {
 public:
  Comparison(const TexturedScene& before, const TexturedScene& after, const Screen& screen,
             Look look)
      : before_(before),
        after_(after),
        look_(look),
        side_(screen.size * kSamples),
        hits_(hits_of(before, screen)),
        old_chart_(before.charts()),
        new_chart_(after.charts()) {
    result_.before = result_.after = {screen.size, screen.size, {}};
  }

  Compared run() {
    const int size = side_ / kSamples;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) compare_pixel(x, y);
    const auto mean = [](double sum, std::size_t count) {
      return count == 0 ? 0 : sum / static_cast<double>(count);
    };
    result_.mean_difference = mean(away_, away_count_);
    result_.near_seams = mean(near_, near_count_);
    result_.share_compared = mean(double(away_count_), away_count_ + near_count_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] const Hit& hit(int x, int y) const {
    return hits_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
                 static_cast<std::size_t>(x)];
  }

  void compare_pixel(int x, int y) {
    std::vector<const Hit*> own;
    for (int j = 0; j < kSamples; ++j)
      for (int i = 0; i < kSamples; ++i) own.push_back(&hit(x * kSamples + i, y * kSamples + j));
    const Vec3 a = pixel_of(before_, own, look_), b = pixel_of(after_, own, look_);
    add_pixel(result_.before, a);
    add_pixel(result_.after, b);
    if (own.front()->face < 0) return;
    const bool is_near = is_near_seam(x, y);
    (is_near ? near_ : away_) += (a - b).cwiseAbs().mean();
    ++(is_near ? near_count_ : away_count_);
  }

  static void add_pixel(texture::Image& image, const Vec3& colour) {
    for (int c = 0; c < 3; ++c)
      image.rgba.push_back(static_cast<std::uint8_t>(std::lround(colour[c])));
    image.rgba.push_back(255);
  }

  /// Whether the pixel and its neighbours show more than one chart, of either scene, or an edge.
  [[nodiscard]] bool is_near_seam(int x, int y) const {
    const auto own = static_cast<std::size_t>(hit(x * kSamples, y * kSamples).face);
    for (int j = -kSamples; j < 2 * kSamples; ++j)
      for (int i = -kSamples; i < 2 * kSamples; ++i) {
        const int face = hit(std::clamp(x * kSamples + i, 0, side_ - 1),
                             std::clamp(y * kSamples + j, 0, side_ - 1))
                             .face;
        if (face < 0) return true;
        const auto other = static_cast<std::size_t>(face);
        if (old_chart_[other] != old_chart_[own] || new_chart_[other] != new_chart_[own])
          return true;
      }
    return false;
  }

  const TexturedScene& before_;
  const TexturedScene& after_;
  Look look_;
  int side_;  ///< samples
  std::vector<Hit> hits_;
  std::vector<int> old_chart_, new_chart_;
  double away_ = 0, near_ = 0;
  std::size_t away_count_ = 0, near_count_ = 0;
  Compared result_;
};

}  // namespace

Compared compare(const TexturedScene& before, const TexturedScene& after, const Vec3& direction,
                 Look look, int size) {
  return Comparison(before, after, screen_of(before, direction, size), look).run();
}

std::vector<Vec3> eight_sides() {
  std::vector<Vec3> sides;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-0.8, 0.8})
      for (const double z : {-1.0, 1.0}) sides.emplace_back(x, y, z * 0.9);
  return sides;
}

}  // namespace unwrapd::test
