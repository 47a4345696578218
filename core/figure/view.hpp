#pragma once
// From where a surface is looked at, and where its points then lie in the picture.

#include <optional>
#include <span>
#include <string_view>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::figure {

/// A parallel projection. Screen coordinates are pixels, x to the right, y down.
struct View {
  Vec3 right, up, toward;      ///< orthonormal; `toward` the one who looks
  double unit = 1;             ///< positions are divided by it first, so that nothing overflows
  Vec2 middle = Vec2::Zero();  ///< of the surface, along right and up
  double pixels = 1;           ///< for each unit
  double centre = 0;           ///< of the picture, in both directions

  [[nodiscard]] Vec2 pixel(const Vec3& position) const;
  /// The greater, the nearer to the one who looks.
  [[nodiscard]] double depth(const Vec3& position) const;
  /// The size of the surface, in pixels: the greater side of its box on the screen.
  double extent = 0;
};

/// From where one looks: degrees, from +Z towards +X and towards +Y.
struct Aspect {
  double azimuth = 0;
  double elevation = 0;
};

/// front (from +Z), back, left (from -X), right, top (from +Y, front below) or bottom.
std::optional<Aspect> aspect_named(std::string_view name);

/// The view that shows most of the surfaces' outer sides among a few from above and aslant, +Y
/// being up (glTF 2.0, Sec. 3.4) and +Z in front; the first of those that are nearly as good. All
/// that faces use is fitted into a square of `size` pixels. A surface without extent lies in the
/// middle. aspect: from there instead.
View view_of(std::span<const Surface> surfaces, int size, const std::optional<Aspect>& aspect = {});

}  // namespace unwrapd::figure
