#pragma once
// Which half-edges of a surface belong together: by position alone, or so that the cuts that its
// vertex numbers make stay open.

#include <array>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/halfedges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/surface_numbers.hpp"
#include "core/mesh/topology.hpp"

namespace unwrapd {

/// Twins over all faces of a surface; faces that are set aside have none.
struct Pairing {
  Halfedges halfedges;
  Index split_edges = 0;                      ///< non-manifold edges left without twins
  std::vector<std::array<Index, 2>> clashes;  ///< two half-edges alone on an edge, one direction
};

/// By position: welded are the surface's faces over welded vertices.
Pairing pair_welded(std::span<const Triangle> welded, const FaceStates& states,
                    const std::stop_token& stop = {});

/// By the surface's own vertex numbers; what is left open between two different primitives is
/// paired by position where just two half-edges meet. A cut inside a primitive stays open.
Pairing pair_keeping_seams(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                           const FaceStates& states, const std::stop_token& stop = {});

/// Whether its faces come from several primitives.
bool spans_parts(const SurfaceNumbers& surface);

/// An edge by its ends, the lower first.
using EdgeEnds = std::array<Index, 2>;

/// Opens the edges listed, ends being welded vertices; they must be in ascending order. Returns the
/// first of them that no face has, or nothing.
std::optional<EdgeEnds> cut_edges(std::span<const Triangle> welded, std::span<const EdgeEnds> edges,
                                  Halfedges& halfedges);

/// Opens the edges at which the UVs that the surface came with differ from one side to the other.
/// Two corners without UVs do not differ.
void cut_at_uv_seams(const SurfaceNumbers& surface, Halfedges& halfedges);

/// Twins the two half-edges of every boundary loop that has no more than two: the slit that a
/// non-manifold edge leaves when it is split inside one sheet, of no use to anyone.
void close_slits(Halfedges& halfedges, const std::stop_token& stop = {});

/// The component of a one-sided surface (a Moebius strip): one that clashes with itself however
/// components are turned over. components are those of pairing.halfedges, one a face.
std::optional<Index> one_sided_component(std::span<const std::array<Index, 2>> clashes,
                                         const Topology& topology);

}  // namespace unwrapd
