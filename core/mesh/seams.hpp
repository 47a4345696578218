#pragma once
// Pairs the half-edges of a surface: by position alone, or so that the cuts of its vertex numbers
// stay open.

#include <array>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/flat_pairs.hpp"
#include "core/mesh/halfedges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/surface_numbers.hpp"
#include "core/mesh/topology.hpp"

namespace unwrapd {

/// Twins over all faces of a surface; faces that are set aside have none.
struct Pairing {
  Halfedges halfedges;
  Index split_edges = 0;  ///< non-manifold edges left without twins
  std::vector<std::array<Index, 2>>
      clashes;                ///< pairs of half-edges alone on an edge, with the same direction
  bool pairs_sheets = false;  ///< some twins are on an edge of more than two faces
};

/// Pairs by position, and the sides of edges of more than two faces by the surface's own vertex
/// numbers, or else as flat_pairs() says, where these tell what goes on into what. welded: the
/// surface's faces over welded vertices.
Pairing pair_welded(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                    const FaceStates& states, std::span<const HalfedgePair> flat = {},
                    const std::stop_token& stop = {});

/// Pairs by the surface's own vertex numbers. Unpaired half-edges of different primitives are then
/// paired by position if they are alone on an edge. A cut inside a primitive stays open.
Pairing pair_keeping_seams(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                           const FaceStates& states, const std::stop_token& stop = {});

/// Whether the surface's faces come from several primitives.
bool spans_parts(const SurfaceNumbers& surface);

/// An edge by its ends, the lower first.
using EdgeEnds = std::array<Index, 2>;

/// Cuts the listed edges, whose ends are welded vertices, in ascending order. Returns the first
/// edge that no face has, or nothing.
std::optional<EdgeEnds> cut_edges(std::span<const Triangle> welded, std::span<const EdgeEnds> edges,
                                  Halfedges& halfedges);

/// Cuts the edges at which the UVs of the input differ between the two sides. Two corners without
/// UVs are equal.
void cut_at_uv_seams(const SurfaceNumbers& surface, Halfedges& halfedges);

/// Opens edges whose faces have different materials; none if the surface has no names of them.
void cut_at_materials(const SurfaceNumbers& surface, Halfedges& halfedges);

/// Pairs the two half-edges of every boundary loop that has no more than two. Splitting a
/// non-manifold edge inside one sheet leaves such slits, which have no use.
void close_slits(Halfedges& halfedges, const std::stop_token& stop = {});

/// The component of a one-sided surface (a Moebius strip): one that clashes with itself whatever
/// orientations components get. components are those of pairing.halfedges, one a face.
std::optional<Index> one_sided_component(std::span<const std::array<Index, 2>> clashes,
                                         const Topology& topology);

}  // namespace unwrapd
