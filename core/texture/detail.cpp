// How large a texture must be to keep the detail of an image in another layout.
#include <algorithm>
#include <cmath>

#include "core/base/cancel.hpp"
#include "core/texture/affine.hpp"

namespace unwrapd::texture {
namespace {

constexpr double kShare = 0.95;  // of the image's area in use that keeps its detail

/// The largest factor by which a map stretches a direction.
double largest_stretch(const Mat2& m) {
  const double a = m.col(0).squaredNorm(), b = m.col(1).squaredNorm(), c = m.col(0).dot(m.col(1));
  return std::sqrt((a + b + std::hypot(a - b, 2 * c)) / 2);
}

struct Need {
  double scale = 0;
  double area = 0;  ///< in texels of the old image
};

}  // namespace

double scale_that_keeps_detail(std::span<const Patch> patches, const Size& page, const Size& old,
                               const std::stop_token& stop) {
  std::vector<Need> needs;
  double total = 0;
  for (const Patch& patch : patches)
    for (const PlacedTriangle& triangle : patch.triangles) {
      check_cancelled_every(needs.size(), stop);
      const std::optional<Affine> map = affine_of(triangle, page);
      if (!map) continue;
      const Mat2 texels = Vec2(old.width, old.height).asDiagonal() * map->linear;
      const double area = std::abs(texels.determinant() / map->barycentric.determinant()) / 2;
      if (!std::isfinite(area)) continue;
      needs.push_back({largest_stretch(texels), area});
      total += area;
    }
  std::sort(needs.begin(), needs.end(),
            [](const Need& a, const Need& b) { return a.scale < b.scale; });
  double kept = 0;
  for (const Need& need : needs)
    if ((kept += need.area) >= kShare * total) return need.scale;
  return 0;
}

}  // namespace unwrapd::texture
