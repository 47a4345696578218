#pragma once
// Finds islands of the same shape.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/outline.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pack {

/// The motion of an island onto the first of its shape: a rotation by cosine and sine, then a
/// translation by offset. It neither mirrors nor scales.
struct CongruentIsland {
  Index as = 0;  ///< the first of its shape; the island itself if it is the first
  double cosine = 1;
  double sine = 0;
  Vec2 offset = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& uv) const {
    return Vec2(cosine * uv.x() - sine * uv.y(), sine * uv.x() + cosine * uv.y()) + offset;
  }
};

/// Two outlines are congruent if a motion takes the corners of one to those of the other, in their
/// order around the island, up to a ten-thousandth of its extent; a translation where rotation is
/// none. One entry an island. Throws Error{cancelled}.
std::vector<CongruentIsland> congruent_islands(std::span<const charts::Outline> islands,
                                               Rotation rotation, const std::stop_token& stop);

}  // namespace unwrapd::pack
