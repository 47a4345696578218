// Pairing by position, pairing that keeps seams, and the test for one-sided surfaces.
//
// A collapsed face (two corners at one position) is an edge with two sides: without it, the two
// neighbouring faces meet. Pairing by position needs no code for this, since their half-edges lie
// on one edge. Pairing by vertex number pairs the collapsed face first and then removes it.
#include "core/mesh/seams.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/parity_sets.hpp"

namespace unwrapd {
namespace {

bool is_open(const Halfedges& halfedges, Index h) { return halfedges.twin[h] == kNoTwin; }

void set_twins(Halfedges& halfedges, Index g, Index h) {
  if (g != kNoTwin) halfedges.twin[g] = h;
  if (h != kNoTwin) halfedges.twin[h] = g;
}

void open_edge(Halfedges& halfedges, Index h) {
  const Index other = std::exchange(halfedges.twin[h], kNoTwin);
  halfedges.twin[other] = kNoTwin;
}

/// The sides of the sound faces, sorted by edge.
std::vector<EdgeSide> sound_sides(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                                  const FaceStates& states, const std::stop_token& stop) {
  auto sides = edge_sides(
      welded, [&](Index h) { return states.of[face_of(h)] == FaceState::sound; }, stop);
  sort_by_edge(sides, surface.vertex_count, stop);
  return sides;
}

/// What decides how sides are paired.
struct Sheets {
  const SurfaceNumbers& surface;
  std::span<const Triangle> faces;          ///< those of the surface, or over welded vertices
  std::span<const HalfedgePair> flat = {};  ///< see flat_pairs()
};

/// Pairs the sides of an edge of several sheets that are alone on an edge of the surface's own
/// vertices: bodies that touch have vertices of their own. Returns the number of pairs.
int pair_by_own_vertices(const SurfaceNumbers& surface, std::span<const Triangle> faces,
                         std::vector<EdgeSide> sides, Halfedges& out) {
  for (EdgeSide& side : sides) side = side_of(surface.faces, side.halfedge);
  std::ranges::sort(sides, {}, [](const EdgeSide& side) {
    return std::array{side.low, side.high, side.halfedge};
  });
  int pairs = 0;
  for_each_run(sides, on_one_edge, [&](const EdgeSide* first, const EdgeSide* last) {
    if (last - first == 2) pairs += pair_edge(faces, {first, last}, out);
  });
  return pairs;
}

/// Pairs the open sides of an edge that are a pair of `flat`, which ascends.
int pair_flat(std::span<const HalfedgePair> flat, std::span<const EdgeSide> sides, Halfedges& out) {
  int pairs = 0;
  for (const EdgeSide& side : sides) {
    const auto found = std::ranges::lower_bound(flat, HalfedgePair{side.halfedge, 0});
    if (found == flat.end() || found->front() != side.halfedge) continue;
    const Index other = found->back();
    if (std::ranges::find(sides, other, &EdgeSide::halfedge) == sides.end()) continue;
    set_twins(out, side.halfedge, other);
    ++pairs;
  }
  return pairs;
}

/// Pairs the sides of an edge of several sheets: by the surface's own vertices, then those that
/// have no choice, then those that are flat.
int pair_sheets(const Sheets& in, std::vector<EdgeSide> sides, Halfedges& out) {
  const auto keep_open = [&] {
    std::erase_if(sides, [&](const EdgeSide& side) { return !is_open(out, side.halfedge); });
  };
  int pairs = pair_by_own_vertices(in.surface, in.faces, sides, out);
  keep_open();
  pairs += pair_edge(in.faces, sides, out);
  keep_open();
  return pairs + pair_flat(in.flat, sides, out);
}

/// Pairs the sides of every edge and counts the edges that cannot be paired.
void pair_all(const Sheets& in, const std::vector<EdgeSide>& sides, const std::stop_token& stop,
              Pairing& out) {
  const auto pair = [&](const EdgeSide* first, const EdgeSide* last) {
    const auto count = last - first;
    if (count == 1) return;
    const int pairs = count == 2 ? pair_edge(in.faces, {first, last}, out.halfedges)
                                 : pair_sheets(in, {first, last}, out.halfedges);
    out.pairs_sheets = out.pairs_sheets || (count > 2 && pairs > 0);
    if (pairs > 0) return;
    const Index g = first[0].halfedge, h = first[1].halfedge;
    const bool clash = count == 2 && start_of(in.faces, g) == start_of(in.faces, h);
    if (clash) out.clashes.push_back({g, h});
    out.split_edges += clash || count > 2;
  };
  for_each_run(sides, on_one_edge, pair, stop);
}

/// Opens the pairs at an edge of more than two faces whose ends are the same two vertices as those
/// of another pair or side there, because their sheets are one around both ends: a list of
/// triangles could not tell them apart. To open a pair divides vertices and joins none, so once is
/// enough. sides: sorted by edge.
void open_coinciding(const std::vector<EdgeSide>& sides, const std::stop_token& stop,
                     Pairing& out) {
  std::vector<EdgeSide> crowded;
  const auto add_if_crowded = [&](const EdgeSide* first, const EdgeSide* last) {
    if (last - first > 2) crowded.insert(crowded.end(), first, last);
  };
  for_each_run(sides, on_one_edge, add_if_crowded, stop);
  if (crowded.empty()) return;
  std::vector<Index>& twin = out.halfedges.twin;
  const CornerVertices vertices = corner_vertices(out.halfedges, stop);
  for (EdgeSide& side : crowded) side = side_of(vertices.faces, side.halfedge);
  sort_by_edge(crowded, vertices.count, stop);
  const auto open = [&](const EdgeSide* first, const EdgeSide* last) {
    const bool is_pair = last - first == 2 && twin[first->halfedge] == first[1].halfedge;
    if (last - first == 1 || is_pair) return;
    ++out.split_edges;
    for (const EdgeSide* side = first; side != last; ++side)
      if (!is_open(out.halfedges, side->halfedge)) open_edge(out.halfedges, side->halfedge);
  };
  for_each_run(crowded, on_one_edge, open, stop);
}

/// Removes a collapsed face: the neighbours across its two long sides become twins.
void take_out(std::span<const Triangle> welded, Index face, Halfedges& halfedges) {
  std::array<Index, 3> outside{};
  for (Index i = 0; i < 3; ++i) outside[i] = std::exchange(halfedges.twin[3 * face + i], kNoTwin);
  for (Index g : outside)
    if (g != kNoTwin) halfedges.twin[g] = kNoTwin;
  for (Index i = 0; i < 3; ++i) {
    const Index h = 3 * face + i;
    if (start_of(welded, h) != end_of(welded, h)) continue;  // h is the short side
    const Index left = outside[(i + 1) % 3], right = outside[(i + 2) % 3];
    if (left == kNoTwin || right == kNoTwin || face_of(left) == face_of(right)) continue;
    set_twins(halfedges, left, right);
    return;
  }
}

/// Pairs by position the two half-edges of different primitives that are alone and unpaired on an
/// edge.
void glue_parts(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                const FaceStates& states, Pairing& out) {
  auto sides = edge_sides(welded, [&](Index h) {
    return states.of[face_of(h)] == FaceState::sound && is_open(out.halfedges, h);
  });
  sort_by_edge(sides, surface.vertex_count);
  for_each_run(sides, on_one_edge, [&](const EdgeSide* first, const EdgeSide* last) {
    if (last - first != 2) return;
    const Index g = first[0].halfedge, h = first[1].halfedge;
    if (surface.part[face_of(g)] == surface.part[face_of(h)]) return;
    if (pair_edge(welded, {first, last}, out.halfedges) > 0) return;
    if (start_of(welded, g) == start_of(welded, h)) out.clashes.push_back({g, h});
  });
}

}  // namespace

bool spans_parts(const SurfaceNumbers& surface) {
  for (Index part : surface.part)
    if (part != surface.part.front()) return true;
  return false;
}

Pairing pair_welded(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                    const FaceStates& states, std::span<const HalfedgePair> flat,
                    const std::stop_token& stop) {
  Pairing out{{std::vector<Index>(3 * welded.size(), kNoTwin)}, 0, {}, false};
  const std::vector<EdgeSide> sides = sound_sides(surface, welded, states, stop);
  pair_all({surface, welded, flat}, sides, stop, out);
  open_coinciding(sides, stop, out);
  return out;
}

Pairing pair_keeping_seams(const SurfaceNumbers& surface, std::span<const Triangle> welded,
                           const FaceStates& states, const std::stop_token& stop) {
  const std::span<const Triangle> faces = surface.faces;
  Pairing out{{std::vector<Index>(3 * faces.size(), kNoTwin)}, 0, {}, false};
  const auto counts = [&](Index h) {
    const FaceState state = states.of[face_of(h)];
    return state == FaceState::sound ||
           (state == FaceState::collapsed && !repeats_vertex(faces[face_of(h)]));
  };
  auto sides = edge_sides(faces, counts, stop);
  sort_by_edge(sides, surface.vertex_count, stop);
  pair_all({surface, faces}, sides, stop, out);
  for (Index t = 0; t < static_cast<Index>(faces.size()); ++t)
    if (states.of[t] == FaceState::collapsed) take_out(welded, t, out.halfedges);
  if (spans_parts(surface)) {
    glue_parts(surface, welded, states, out);
    sides = sound_sides(surface, welded, states, stop);
  }
  open_coinciding(sides, stop, out);
  return out;
}

std::optional<EdgeEnds> cut_edges(std::span<const Triangle> welded, std::span<const EdgeEnds> edges,
                                  Halfedges& halfedges) {
  std::vector<char> found(edges.size(), 0);
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h) {
    const Index a = start_of(welded, h), b = end_of(welded, h);
    const EdgeEnds edge{std::min(a, b), std::max(a, b)};
    const auto at = std::lower_bound(edges.begin(), edges.end(), edge);
    if (at == edges.end() || *at != edge) continue;
    found[at - edges.begin()] = 1;
    if (!is_open(halfedges, h)) open_edge(halfedges, h);
  }
  const auto missing = std::find(found.begin(), found.end(), 0);
  if (missing == found.end()) return std::nullopt;
  return edges[missing - found.begin()];
}

void cut_at_uv_seams(const SurfaceNumbers& surface, Halfedges& halfedges) {
  const auto same = [](const Vec2& a, const Vec2& b) {
    return a == b || (a.hasNaN() && b.hasNaN());
  };
  const auto at = [&](Index h) -> const Vec2& { return surface.corner_uv[h / 3][h % 3]; };
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h) {
    const Index twin = halfedges.twin[h];
    if (twin == kNoTwin || h > twin) continue;
    if (!same(at(h), at(next_halfedge(twin))) || !same(at(next_halfedge(h)), at(twin)))
      open_edge(halfedges, h);
  }
}

void cut_at_materials(const SurfaceNumbers& surface, Halfedges& halfedges) {
  if (surface.materials.empty()) return;
  const auto material = [&](Index h) -> const std::string& {
    return surface.materials[surface.part[face_of(h)]];
  };
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h) {
    const Index twin = halfedges.twin[h];
    if (twin != kNoTwin && h < twin && material(h) != material(twin)) open_edge(halfedges, h);
  }
}

void close_slits(Halfedges& halfedges, const std::stop_token& stop) {
  const auto next_open = [&](Index h) {
    Index g = next_halfedge(h);
    while (!is_open(halfedges, g)) g = next_halfedge(halfedges.twin[g]);
    return g;
  };
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h) {
    check_cancelled_every(h, stop);
    if (!is_open(halfedges, h)) continue;
    const Index g = next_open(h);
    if (g != h && next_open(g) == h) set_twins(halfedges, g, h);
  }
}

std::optional<Index> one_sided_component(std::span<const std::array<Index, 2>> clashes,
                                         const Topology& topology) {
  ParitySets sides(topology.components.size());
  for (const auto& [g, h] : clashes) {
    const Index a = topology.component_of[face_of(g)], b = topology.component_of[face_of(h)];
    if (!sides.relate(a, b, true)) return a;
  }
  return std::nullopt;
}

}  // namespace unwrapd
