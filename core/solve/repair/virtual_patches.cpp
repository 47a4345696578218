// The virtual boundary's map has no flips, but moves the whole disk to remove one of them. So a
// patch of it is aligned with its rim in the old map by the best similarity, and the remaining
// offset at the rim is spread over the patch smoothly (uniform Laplacian). This may flip triangles
// again, above all where the surface's boundary crosses the patch; the barrier turns them back.
#include "core/solve/repair/virtual_patches.hpp"

#include "core/linear/dominant_lu.hpp"
#include "core/measure/orientation.hpp"
#include "core/solve/repair/settle.hpp"
#include "core/solve/repair/turn_over.hpp"
#include "core/solve/repair/virtual_boundary.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr int kMostPatchRings = 64;

Vec2 complex_product(const Vec2& by, const Vec2& u) {
  return {by.x() * u.x() - by.y() * u.y(), by.x() * u.y() + by.y() * u.x()};
}

/// Aligns map with `to` by the similarity that fits best over the vertices that are not free.
UvMap align_onto(const linear::FreeVertices& free, const UvMap& to, UvMap map) {
  Vec2 here = Vec2::Zero(), there = Vec2::Zero(), across = Vec2::Zero();
  double count = 0, spread = 0;
  const auto for_rim = [&](const auto& visit) {
    for (std::size_t v = 0; v < map.size(); ++v)
      if (free.slot[v] == linear::kFixed) visit(v);
  };
  for_rim([&](std::size_t v) { here += map[v], there += to[v], ++count; });
  if (count == 0) return map;
  here /= count, there /= count;
  for_rim([&](std::size_t v) {
    const Vec2 d = map[v] - here;
    across += complex_product({d.x(), -d.y()}, to[v] - there);
    spread += d.squaredNorm();
  });
  if (!(spread > 0)) return map;
  for (Vec2& u : map) u = there + complex_product(across / spread, u - here);
  return map;
}

/// The patch of `map`, deformed so that its rim lies where it does in `to`.
UvMap bend_into(const Patch& patch, const UvMap& to, UvMap map) {
  const std::vector<Index>& slot = patch.mesh.free.slot;
  map = align_onto(patch.mesh.free, to, std::move(map));
  std::vector<Eigen::Triplet<double, Index>> entries;
  std::vector<Vec2> shift(static_cast<std::size_t>(patch.mesh.free.count), Vec2::Zero());
  for (const Triangle& face : patch.mesh.faces)
    for (const Index v : face)
      for (const Index w : face) {
        if (v == w || slot[v] == linear::kFixed) continue;
        entries.emplace_back(slot[v], slot[v], 1);
        if (slot[w] == linear::kFixed)
          shift[slot[v]] += to[w] - map[w];
        else
          entries.emplace_back(slot[v], slot[w], -1);
      }
  linear::SparseMatrix matrix(patch.mesh.free.count, patch.mesh.free.count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  linear::solve_dominant(matrix, shift, patch.mesh.stop);
  for (std::size_t v = 0; v < map.size(); ++v)
    map[v] = slot[v] == linear::kFixed ? to[v] : Vec2(map[v] + shift[slot[v]]);
  return map;
}

/// As short a way as possible from one map of a patch to another; flips on it are turned over.
/// Empty if that fails.
UvMap partway(const Patch& patch, const MapIntent& intent, const UvMap& from, const UvMap& to) {
  for (const double share : {0.25, 0.5, 1.0}) {
    UvMap own = from;
    for (std::size_t v = 0; v < own.size(); ++v)
      if (patch.mesh.free.slot[v] != linear::kFixed) own[v] += share * (to[v] - from[v]);
    turn_over(patch.mesh, intent, 0, own);
    if (is_untangled(patch.mesh, own)) return own;
  }
  return {};
}

bool is_whole(const Disk& disk, const Patch& patch) {
  return patch.mesh.free.count == disk.vertex_count();
}

}  // namespace

bool mend_by_virtual_boundary(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  std::vector<Index> flipped = measure::flipped_faces(disk.faces, uv, disk.stop);
  const UvMap upright = virtual_boundary_map(disk, uv);
  std::vector<char> is_mended(disk.faces.size(), 0);
  bool has_mended = false;
  for (int rings = intent.rings; rings <= kMostPatchRings && !flipped.empty(); rings *= 2) {
    for (Patch& patch : patches_around(disk, flipped, rings, intent.constrained)) {
      if (is_whole(disk, patch)) return start_anew(disk, intent, upright, uv) || has_mended;
      const UvMap old = map_of(patch, uv);
      UvMap own = partway(patch, intent, old, bend_into(patch, old, map_of(patch, upright)));
      if (own.empty()) continue;
      settle(disk, intent, patch, own);
      put_back(patch, own, uv);
      for (Index t : patch.face) is_mended[t] = 1;
      has_mended = true;
    }
    flipped = measure::flipped_faces(disk.faces, uv, disk.stop);
  }
  if (flipped.empty()) widen_needles(disk, intent, is_mended, uv);
  return has_mended;
}

}  // namespace unwrapd::solve::repair
