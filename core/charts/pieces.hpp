#pragma once
// The sound faces of a surface, paired as its seams ask for: what charts are made of.

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/seams.hpp"
#include "core/mesh/topology.hpp"

namespace unwrapd::charts {

/// The sound faces of a surface and how they hang together.
struct Pieces {
  std::vector<Index> source;  ///< face -> face of the surface
  Halfedges halfedges;
  CornerVertices corners;  ///< of halfedges
  Topology topology;
  Index split_edges = 0;
  std::vector<std::array<Index, 2>> clashes;
  bool may_crease = true;  ///< false: twins have the same vertices and the same material
};

/// A surface with what weld() and inspect_faces() say of it: not where its vertices lie.
struct Inspected {
  SurfaceNumbers surface;
  std::span<const Index> first_at;
  std::span<const Triangle> welded;
  const FaceStates& states;
};

/// The pieces that the mode asks for, and whether vertices were welded for them. by_place: what
/// pair_welded() says. Throws Error{invalid_option}, see components_of().
std::pair<Pieces, bool> choose_pieces(const Inspected& in, const Pairing& by_place,
                                      const SeamRules& seams);

}  // namespace unwrapd::charts
