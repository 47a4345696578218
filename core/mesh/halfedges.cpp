// Twins by sorting half-edges, and the walk along boundaries.
//
// All half-edges are sorted by lower end with a counting sort, the few of each by their higher end;
// those on one edge are then neighbours. A hash map of edges is the usual way: slower, and its time
// depends on input.
#include "core/mesh/halfedges.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kFew = 16;              // sides that are sorted by insertion
constexpr std::size_t kMaxSidesThatPair = 4;  // a double-sided sheet's inner edge

bool can_be_twins(std::span<const Triangle> faces, Index g, Index h) {
  return start_of(faces, g) == end_of(faces, h) && apex_of(faces, g) != apex_of(faces, h);
}

/// The fast path of pair_edge() for an edge of two sides.
int pair_two(std::span<const Triangle> faces, Index g, Index h, Halfedges& out) {
  if (!can_be_twins(faces, g, h)) return 0;
  out.twin[g] = h;
  out.twin[h] = g;
  return 1;
}

/// The only half-edge among sides that h can be paired with; kNoTwin if there is none, or several.
Index only_partner(std::span<const Triangle> faces, std::span<const EdgeSide> sides, Index h) {
  Index partner = kNoTwin;
  for (const EdgeSide& side : sides) {
    if (!can_be_twins(faces, side.halfedge, h)) continue;
    if (partner != kNoTwin) return kNoTwin;
    partner = side.halfedge;
  }
  return partner;
}

/// Whether a side other than h has g as its only partner.
bool is_needed_by_another(std::span<const Triangle> faces, std::span<const EdgeSide> sides, Index g,
                          Index h) {
  return std::ranges::any_of(sides, [&](const EdgeSide& side) {
    return side.halfedge != h && only_partner(faces, sides, side.halfedge) == g;
  });
}

/// The boundary half-edge after h: rotates about h's end to the end of the fan.
Index next_on_boundary(const Halfedges& halfedges, Index h) {
  Index g = next_halfedge(h);
  while (halfedges.twin[g] != kNoTwin) g = next_halfedge(halfedges.twin[g]);
  return g;
}

/// Stable. Usually a vertex is the lower end of about three sides, but it may be that of all.
void sort_by_high(std::span<EdgeSide> sides) {
  const auto is_lower = [](const EdgeSide& a, const EdgeSide& b) { return a.high < b.high; };
  if (sides.size() > kFew) {
    std::stable_sort(sides.begin(), sides.end(), is_lower);
    return;
  }
  for (std::size_t k = 1; k < sides.size(); ++k)
    for (std::size_t i = k; i > 0 && is_lower(sides[i], sides[i - 1]); --i)
      std::swap(sides[i], sides[i - 1]);
}

double length(const TriMesh& mesh, const BoundaryLoop& loop) {
  double sum = 0;
  for (Index h : loop)
    sum += (mesh.positions[end_of(mesh.faces, h)] - mesh.positions[start_of(mesh.faces, h)]).norm();
  return sum;
}

}  // namespace

void sort_by_edge(std::vector<EdgeSide>& sides, Index vertex_count, const std::stop_token& stop) {
  counting_sort(
      sides, vertex_count, [](const EdgeSide& side) { return side.low; }, stop);
  std::size_t step = 0;
  for (auto first = sides.begin(); first != sides.end(); ++step) {
    check_cancelled_every(step, stop);
    const auto last = std::find_if(first, sides.end(),
                                   [&](const EdgeSide& side) { return side.low != first->low; });
    sort_by_high(std::span(first, last));
    first = last;
  }
}

int pair_edge(std::span<const Triangle> faces, std::span<const EdgeSide> sides, Halfedges& out) {
  if (sides.size() == 2) return pair_two(faces, sides[0].halfedge, sides[1].halfedge, out);
  if (sides.size() > kMaxSidesThatPair) return 0;
  int pairs = 0;
  for (const EdgeSide& side : sides) {
    const Index h = side.halfedge;
    const Index g = only_partner(faces, sides, h);
    if (g == kNoTwin || out.twin[h] == g || is_needed_by_another(faces, sides, g, h)) continue;
    out.twin[h] = g;
    out.twin[g] = h;
    ++pairs;
  }
  return pairs;
}

Halfedges build_halfedges(std::span<const Triangle> faces, Index vertex_count,
                          const std::stop_token& stop) {
  Halfedges halfedges{std::vector<Index>(3 * faces.size(), kNoTwin)};
  auto sides = edge_sides(
      faces, [&](Index h) { return !repeats_vertex(faces[face_of(h)]); }, stop);
  sort_by_edge(sides, vertex_count, stop);
  for_each_run(
      sides, on_one_edge,
      [&](const EdgeSide* first, const EdgeSide* last) {
        pair_edge(faces, {first, last}, halfedges);
      },
      stop);
  return halfedges;
}

std::vector<BoundaryLoop> boundary_loops(const Halfedges& halfedges, const std::stop_token& stop) {
  std::vector<BoundaryLoop> loops;
  std::vector<bool> seen(halfedges.twin.size(), false);
  for (Index start = 0; start < static_cast<Index>(seen.size()); ++start) {
    check_cancelled_every(start, stop);
    if (seen[start] || halfedges.twin[start] != kNoTwin) continue;
    BoundaryLoop& loop = loops.emplace_back();
    for (Index h = start; !seen[h]; h = next_on_boundary(halfedges, h)) {
      seen[h] = true;
      loop.push_back(h);
    }
  }
  return loops;
}

void sort_by_length(const TriMesh& mesh, std::vector<BoundaryLoop>& loops) {
  std::vector<std::pair<double, BoundaryLoop>> by_length;
  by_length.reserve(loops.size());
  for (BoundaryLoop& loop : loops) {
    const double own = length(mesh, loop);
    by_length.emplace_back(own, std::move(loop));
  }
  std::stable_sort(by_length.begin(), by_length.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t k = 0; k < loops.size(); ++k) loops[k] = std::move(by_length[k].second);
}

std::vector<BoundaryLoop> boundary_loops(const TriMesh& mesh, const Halfedges& halfedges,
                                         const std::stop_token& stop) {
  assert(halfedges.twin.size() == 3 * mesh.faces.size());
  std::vector<BoundaryLoop> loops = boundary_loops(halfedges, stop);
  sort_by_length(mesh, loops);
  return loops;
}

}  // namespace unwrapd
