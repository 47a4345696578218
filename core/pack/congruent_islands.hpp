#pragma once
// Islands of the same shape.

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/outline.hpp"

namespace unwrapd::pack {

/// How an island lies beside the first of its shape: cosine and sine turn it, offset moves it onto
/// that one. No mirroring, no scaling.
struct CongruentIsland {
  Index as = 0;  ///< the first of its shape; itself where nothing earlier is
  double cosine = 1;
  double sine = 0;
  Vec2 offset = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& uv) const {
    return Vec2(cosine * uv.x() - sine * uv.y(), sine * uv.x() + cosine * uv.y()) + offset;
  }
};

/// Outlines are the same when their corners come to lie on each other, in their order around the
/// island, to a ten-thousandth of its extent. One entry an island. Throws Error{cancelled}.
std::vector<CongruentIsland> congruent_islands(std::span<const charts::Outline> islands,
                                               const std::stop_token& stop);

}  // namespace unwrapd::pack
