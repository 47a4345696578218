// The vertices to split follow from the faces alone: each new vertex of a surface gets the pool's
// own vertex if it is the first for it, else a copy.
#include "core/asset/writer/split.hpp"

#include <algorithm>
#include <cassert>

#include "core/asset/base/as_size.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::writer {
namespace {

constexpr Index kNotPlaced = -1;

}  // namespace

Splitter::Splitter(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped)
    : gltf_(gltf), unwrapped_(unwrapped), placed_(unwrapped.size()) {
  assert(unwrapped.size() == gltf.vertices.size());
}

/// The first vertex of a surface for a pool's vertex gets it; others get copies.
Index Splitter::place_corner(const Piece& piece, Index corner, Split& split) {
  Index& number = placed_[piece.surface][as_size(corner)];
  if (number != kNotPlaced) return number;
  const UnwrappedSurface& surface = unwrapped_[piece.surface];
  const Index original = gltf_.vertices[piece.surface][as_size(surface.source[as_size(corner)])];
  number = original;
  if (taken_[as_size(original)] != 0) {
    number = static_cast<Index>(taken_.size() + split.copies.size());
    split.copies.push_back(original);
    split.uv.emplace_back();
  }
  taken_[as_size(original)] = 1;
  const Vec2& uv = surface.uv[as_size(corner)];
  split.uv[as_size(number)] = {static_cast<float>(uv.x()), static_cast<float>(1 - uv.y())};
  return number;
}

void Splitter::forget(const Piece& piece) {
  const UnwrappedSurface& surface = unwrapped_[piece.surface];
  for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t)
    for (const Index corner : surface.faces[t])
      placed_[piece.surface][as_size(corner)] = kNotPlaced;
}

Split Splitter::split(const std::vector<std::size_t>& pieces, std::size_t vertex_count, bool all) {
  Split split;
  split.uv.resize(vertex_count);
  taken_.assign(vertex_count, 0);
  for (const std::size_t p : pieces) {
    const Piece& piece = gltf_.pieces[p];
    const UnwrappedSurface& surface = unwrapped_[piece.surface];
    std::vector<Index>& placed = placed_[piece.surface];
    if (placed.empty()) placed.assign(surface.source.size(), kNotPlaced);
    std::vector<Index> corners;
    corners.reserve(3 * piece.face_count);
    for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
      check_cancelled_every(t, gltf_.stop);
      for (const Index corner : surface.faces[t])
        corners.push_back(place_corner(piece, corner, split));
    }
    const auto is_copy = [&](Index corner) { return as_size(corner) >= vertex_count; };
    if (std::any_of(corners.begin(), corners.end(), is_copy)) split.changed.insert(p);
    if (all || split.changed.contains(p)) split.corners[p] = std::move(corners);
  }
  for (const std::size_t p : pieces) forget(gltf_.pieces[p]);
  return split;
}

}  // namespace unwrapd::asset::writer
