// How large a scene shows its meshes. The page has texels for what is seen: a mesh of one unit that
// a node makes ten times as large gets ten times the texels along its sides.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/asset/gltf/scene.hpp"
#include "core/asset/reader/steps.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr double kLeastScale = 1e-12;  ///< of a flat mesh that a node shows from its edge, less
constexpr double kRounding = 1e-5;     ///< of scales by products of floats

/// The scale of lengths: the root of the area ratio. It is exact for a uniform scale and for a
/// plane.
std::optional<double> scale_of(const ScaledPlacement& shown) {
  const double scale = std::sqrt(shown.area_ratio);
  if (!(scale >= kLeastScale)) return std::nullopt;
  return std::abs(scale - 1) <= kRounding ? 1 : scale;
}

}  // namespace

void set_scales(const Gltf& gltf, std::vector<Surface>& surfaces) {
  const std::vector<std::optional<ScaledPlacement>> shown = largest_shown(gltf, surfaces);
  std::vector<std::optional<double>> scales(surfaces.size());
  std::optional<double> least;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (shown[s]) scales[s] = scale_of(*shown[s]);
    if (scales[s]) least = std::min(*scales[s], least.value_or(*scales[s]));
  }
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    surfaces[s].scale = scales[s].value_or(least.value_or(1));
}

}  // namespace unwrapd::asset::reader
