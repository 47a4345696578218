#pragma once
// Islands side by side on square pages, at one texel density, never overlapping.

#include <span>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pack {

/// Where an island goes: uv_page = scale * (rotation * uv) + offset. No mirroring: rotation is
/// proper. scale is common to all islands. Page k is the square [k, k+1] x [0, 1].
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
  int resolution = 1024;  ///< texels a side
  int padding = 2;        ///< texels between islands and to a page's border
  Packing packing = {};
};

struct Packed {
  std::vector<Placement> placements;
  Index pages = 1;
  double padding = 0;  ///< texels that are kept: fewer than asked for where islands crowd
  std::vector<char> is_stacked = {};  ///< [island]: lies on another; empty: none does
};

/// Places the islands (each a UV map at the density it shall keep relative to the others: UV area =
/// 3D area; at least one point each) on the page, in true smallest rectangles, at least the padding
/// apart and from the border. Deterministic; near-linear in the number of islands. Where so many
/// islands come that padding would take more than half of the page's side, it is shrunk to that.
std::vector<Placement> pack_in_rows(std::span<const UvMap> islands, const PageOptions& page);

/// The padding that so many islands leave, texels: see pack_in_rows().
double kept_padding(const PageOptions& page, std::size_t island_count);

/// The same by true outlines, into each other's hollows and holes: as large as fits, or at
/// packing.texels_per_unit. Identical islands share a place where packing asks for it. The same
/// bytes on every machine and for any number of threads: the search has a budget of work, not of
/// time. Throws Error{does_not_fit} when a given density needs more pages than allowed;
/// Error{cancelled}.
Packed pack(std::span<const charts::Outline> islands, const PageOptions& page, Executor& executor);

/// The share of a page that the islands would fill, at a glance and without padding; 1 where they
/// have no extent. The search ends where it has come to `enough`. Throws Error{cancelled}.
double rough_fill(std::span<const charts::Outline> islands, double enough = 1,
                  const std::stop_token& stop = {});

}  // namespace unwrapd::pack
