#pragma once
// Packs islands on pages, at one texel density, without overlaps.

#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pack {

/// The position of an island: uv_page = scale * (rotation * uv) + offset. rotation is proper, so
/// nothing is mirrored. scale is common to all islands. Page k is [k, k+1] x [0, aspect]: its width
/// is the unit of length of both axes.
struct Placement {
  double cosine = 1;
  double sine = 0;
  double scale = 1;
  Vec2 offset = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& uv) const {
    return scale * Vec2(cosine * uv.x() - sine * uv.y(), sine * uv.x() + cosine * uv.y()) + offset;
  }
};

struct PageOptions {
  int resolution = 1024;  ///< texels along U, and along V unless there is a height
  int padding = 2;        ///< texels between islands and to a page's border
  Packing packing = {};
  Effort effort = Effort::balanced;
  std::optional<int> height = {};  ///< texels along V

  [[nodiscard]] double aspect() const {
    return static_cast<double>(height.value_or(resolution)) / resolution;
  }
};

struct PackResult {
  std::vector<Placement> placements;
  Index pages = 1;
  double padding = 0;                 ///< texels; less than requested if there are many islands
  std::vector<char> is_stacked = {};  ///< [island]: lies on another one; empty: none does
};

/// Places the islands on the page in their smallest rectangles, at least the padding apart and from
/// the border. Each is a UV map of at least one point, at its relative density (UV area = 3D area).
/// Deterministic; near-linear in the number of islands. If the islands are so many that padding
/// would take more than half of a side of the page, the padding is reduced to that.
std::vector<Placement> pack_in_rows(std::span<const UvMap> islands, const PageOptions& page);

/// The same for outlines, turned as packing.rotation allows.
std::vector<Placement> pack_outlines_in_rows(std::span<const charts::Outline> islands,
                                             const PageOptions& page);

/// The padding that remains for this many islands, texels: see pack_in_rows().
double kept_padding(const PageOptions& page, std::size_t island_count);

/// Packs by true outlines, into each other's hollows and holes: as large as fits, or at
/// packing.texels_per_unit. Congruent islands share a place if packing asks for it. The same bytes
/// on every machine and for any number of threads: the search has a budget of work, not of time.
/// Throws Error{does_not_fit} if a given density needs more pages than allowed; Error{cancelled}.
PackResult pack(std::span<const charts::Outline> islands, const PageOptions& page,
                Executor& executor);

struct RoughRules {
  double enough = 1;  ///< share of the page at which the search ends
  double work = 1;    ///< in shares of the usual amount, (0, 1]
};

/// A quick estimate of the share of a page that the islands would fill, without padding; 1 if they
/// have no extent. Throws Error{cancelled}.
double rough_fill(std::span<const charts::Outline> islands, const RoughRules& rules = {},
                  const std::stop_token& stop = {});

}  // namespace unwrapd::pack
