#pragma once
// The sound faces of a surface, paired as its seams require. Charts are made from them.

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/seams.hpp"
#include "core/mesh/topology.hpp"

namespace unwrapd::charts {

/// The sound faces of a surface and their connectivity.
struct Pieces {
  std::vector<Index> source;  ///< face -> face of the surface
  Halfedges halfedges;
  CornerVertices corners;  ///< of halfedges
  Topology topology;
  Index split_edges = 0;
  std::vector<std::array<Index, 2>> clashes;
  bool may_crease = true;  ///< false: twins have the same vertices and the same material
};

/// A surface with the results of weld() and inspect_faces(), without positions.
struct InspectedSurface {
  SurfaceNumbers surface;
  std::span<const Index> first_at;
  std::span<const Triangle> welded;
  const FaceStates& states;
  std::span<const HalfedgePair> flat;  ///< see flat_pairs()
};

/// The pieces that the mode requires, and whether vertices were welded for them. by_place: the
/// result of pair_welded(). Throws Error{invalid_option}, see components_of().
std::pair<Pieces, bool> choose_pieces(const InspectedSurface& in, const Pairing& by_place,
                                      const SeamRules& seams);

}  // namespace unwrapd::charts
