// SeamMode::automatic keeps the surface's own cuts if they make it a few disks, since somebody then
// opened the model on purpose. A flat-shaded export or a triangle soup is hundreds of tiny "disks",
// and a model with the seams of an old atlas has many more disks than components; both are welded.
// The bounds below separate the two cases by a wide margin.
#include "core/charts/pieces.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/charts/path_edges.hpp"
#include "core/mesh/seams.hpp"

namespace unwrapd::charts {
namespace {

constexpr std::size_t kMostKeptDisks = 64;           // in all
constexpr std::size_t kMostKeptDisksAComponent = 4;  // for each component of the welded surface
constexpr std::size_t kLeastFacesADisk = 8;          // on average

/// Leaves out the faces that are set aside.
Pieces pieces_of(const Pairing& pairing, const FaceStates& states, const std::stop_token& stop) {
  throw_if_cancelled(stop);
  Pieces pieces;
  std::vector<Index> rank(states.of.size(), kNoFace);
  for (std::size_t t = 0; t < states.of.size(); ++t) {
    check_cancelled_every(t, stop);
    if (states.of[t] != FaceState::sound) continue;
    rank[t] = static_cast<Index>(pieces.source.size());
    pieces.source.push_back(static_cast<Index>(t));
  }
  const auto moved = [&](Index h) { return h == kNoTwin ? kNoTwin : 3 * rank[h / 3] + h % 3; };
  pieces.halfedges.twin.resize(3 * pieces.source.size());
  for (std::size_t h = 0; h < pieces.halfedges.twin.size(); ++h) {
    check_cancelled_every(h, stop);
    pieces.halfedges.twin[h] = moved(pairing.halfedges.twin[3 * pieces.source[h / 3] + h % 3]);
  }
  close_slits(pieces.halfedges, stop);
  throw_if_cancelled(stop);
  pieces.corners = corner_vertices(pieces.halfedges, stop);
  pieces.topology = topology(pieces.corners.faces, pieces.halfedges, stop);
  pieces.split_edges = pairing.split_edges;
  for (const auto& [g, h] : pairing.clashes)
    if (rank[g / 3] != kNoFace && rank[h / 3] != kNoFace)
      pieces.clashes.push_back({moved(g), moved(h)});
  return pieces;
}

bool is_a_few_disks(const Pieces& kept, const Pieces& welded) {
  const auto& components = kept.topology.components;
  const std::size_t count = components.size();
  const auto is_disk = [](const Component& c) { return c.is_disk(); };
  return count <= kMostKeptDisks &&
         count <= kMostKeptDisksAComponent * welded.topology.components.size() &&
         count * kLeastFacesADisk <= kept.source.size() &&
         std::all_of(components.begin(), components.end(), is_disk);
}

void cut_paths(const InspectedSurface& in, const SeamRules& seams, Halfedges& halfedges) {
  for (std::size_t k = 0; k < seams.paths.size(); ++k) {
    if (seams.paths[k].surface != seams.surface) continue;
    const PathName name{"seam_edges", k};
    const std::vector<EdgeEnds> edges = path_edges(in.first_at, seams.paths[k], name);
    if (const auto missing = cut_edges(in.welded, edges, halfedges)) refuse_missing(name, *missing);
  }
}

Pieces welded_pieces(const InspectedSurface& in, Pairing pairing, const SeamRules& seams) {
  if (seams.mode == SeamMode::uv0 && !in.surface.corner_uv.empty())
    cut_at_uv_seams(in.surface, pairing.halfedges);
  cut_at_materials(in.surface, pairing.halfedges);
  cut_paths(in, seams, pairing.halfedges);
  return pieces_of(pairing, in.states, seams.stop);
}

Pieces kept_pieces(const InspectedSurface& in, Pairing pairing, const SeamRules& seams) {
  cut_at_materials(in.surface, pairing.halfedges);
  cut_paths(in, seams, pairing.halfedges);
  return pieces_of(pairing, in.states, seams.stop);
}

}  // namespace

std::pair<Pieces, bool> choose_pieces(const InspectedSurface& in, const Pairing& by_place,
                                      const SeamRules& seams) {
  const bool nothing_to_weld = std::ranges::equal(in.welded, in.surface.faces);
  const bool is_plain = nothing_to_weld && !spans_parts(in.surface);  // no rule opens a seam
  const auto kept = [&] {
    Pieces pieces = kept_pieces(
        in, is_plain ? by_place : pair_keeping_seams(in.surface, in.welded, in.states, seams.stop),
        seams);
    pieces.may_crease = !is_plain;
    return pieces;
  };
  const bool by_uv = seams.mode == SeamMode::uv0 && !in.surface.corner_uv.empty();
  if (seams.mode == SeamMode::none || by_uv)
    return {welded_pieces(in, by_place, seams), !nothing_to_weld};
  if (seams.mode == SeamMode::keep || nothing_to_weld) return {kept(), false};
  Pieces with_cuts = kept();
  throw_if_cancelled(seams.stop);
  Pieces without = welded_pieces(in, by_place, seams);
  const bool same = with_cuts.halfedges.twin == without.halfedges.twin;
  if (same || is_a_few_disks(with_cuts, without)) return {std::move(with_cuts), false};
  return {std::move(without), true};
}

}  // namespace unwrapd::charts
