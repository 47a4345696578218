// A degenerate face has three points on one line in space, but not in the plane: spread over its
// vertices' own places it could cover half of the page. So it is laid on an edge that it shares
// with a charted face. Edges are compared by vertices first, so that few vertices need copies, then
// by positions.
#include "core/pipeline/set_aside.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::pipeline {
namespace {

bool is_charted(const Triangle& corners) { return corners[0] != kUncharted; }

/// Corner by corner what the original shows at the same positions.
Triangle corners_like(const Surface& surface, Index face, Index original, const Triangle& shown) {
  const auto position = [&](Index t, int i) -> const Vec3& {
    return surface.mesh.positions[surface.mesh.faces[t][i]];
  };
  int turn = 0;
  while (turn < 2 && position(original, turn) != position(face, 0)) ++turn;
  return {shown[turn], shown[(turn + 1) % 3], shown[(turn + 2) % 3]};
}

/// Lays degenerate faces on edges of charted ones.
class EdgeBorrower {
 public:
  EdgeBorrower(const TriMesh& mesh, const std::vector<Index>& open, std::vector<Triangle>& at)
      : mesh_(mesh), at_(at), is_open_(at.size(), 0), is_charted_(at.size(), 0) {
    for (std::size_t t = 0; t < at.size(); ++t)
      is_charted_[t] = pipeline::is_charted(at[t]) ? 1 : 0;
    for (const Index t : open) is_open_[t] = 1;
  }

  /// faces: the mesh's, over the vertices by which edges are told apart.
  void borrow(const std::vector<Triangle>& faces, const std::stop_token& stop) {
    std::vector<EdgeSide> sides = sides_near_open(faces, stop);
    sort_by_edge(sides, mesh_.vertex_count(), stop);
    for_each_run(
        sides, on_one_edge,
        [&](const EdgeSide* first, const EdgeSide* last) {
          const auto* lender = std::find_if(
              first, last, [&](const EdgeSide& s) { return is_charted_[s.halfedge / 3] != 0; });
          for (const EdgeSide* s = first; lender != last && s != last; ++s)
            if (is_open_[s->halfedge / 3] != 0) lay_on_edge(faces, s->halfedge, lender->halfedge);
        },
        stop);
  }

 private:
  [[nodiscard]] std::vector<EdgeSide> sides_near_open(const std::vector<Triangle>& faces,
                                                      const std::stop_token& stop) const {
    std::vector<char> is_touched(mesh_.positions.size(), 0);
    for (std::size_t t = 0; t < faces.size(); ++t)
      for (const Index v : faces[t]) is_touched[v] |= is_open_[t];
    const auto is_wanted = [&](Index h) {
      const Index a = start_of(faces, h), b = end_of(faces, h);
      return a != b && is_touched[a] != 0 && is_touched[b] != 0 &&
             (is_open_[h / 3] | is_charted_[h / 3]) != 0;
    };
    return edge_sides(faces, is_wanted, stop);
  }

  /// The third corner goes to the nearer end.
  void lay_on_edge(const std::vector<Triangle>& faces, Index own, Index lender) {
    const Index start = own % 3, end = next_halfedge(own) % 3, apex = previous_halfedge(own) % 3;
    const bool same_way = start_of(faces, own) == start_of(faces, lender);
    const Index next = next_halfedge(lender);
    const Index at_start = at_[lender / 3][(same_way ? lender : next) % 3];
    const Index at_end = at_[lender / 3][(same_way ? next : lender) % 3];
    const auto position = [&](Index corner) -> const Vec3& {
      return mesh_.positions[mesh_.faces[own / 3][corner]];
    };
    const bool ends_nearer =
        (position(apex) - position(end)).norm() < (position(apex) - position(start)).norm();
    Triangle& corners = at_[own / 3];
    corners[start] = at_start;
    corners[end] = at_end;
    corners[apex] = ends_nearer ? at_end : at_start;
    is_open_[own / 3] = 0;
  }

  const TriMesh& mesh_;
  std::vector<Triangle>& at_;
  std::vector<char> is_open_;     ///< degenerate and not laid down yet
  std::vector<char> is_charted_;  ///< by a chart
};

/// For each vertex the first chart vertex that it shows, or that one at its position shows.
std::vector<Index> known_places(const TriMesh& mesh, const std::vector<Index>& first_at,
                                const std::vector<Triangle>& at) {
  std::vector<Index> of_vertex(mesh.positions.size(), kUncharted);
  std::vector<Index> of_position = of_vertex;
  for (Index c = 0; c < static_cast<Index>(3 * mesh.faces.size()); ++c) {
    const Index v = mesh.faces[c / 3][c % 3], shown = at[c / 3][c % 3];
    if (of_vertex[v] == kUncharted) of_vertex[v] = shown;
    if (of_position[first_at[v]] == kUncharted) of_position[first_at[v]] = shown;
  }
  for (std::size_t v = 0; v < of_vertex.size(); ++v)
    if (of_vertex[v] == kUncharted) of_vertex[v] = of_position[first_at[v]];
  return of_vertex;
}

/// All corners to the first place that one of the face's vertices has.
void lay_on_points(const TriMesh& mesh, const std::vector<Index>& open,
                   const std::vector<Index>& first_at, std::vector<Triangle>& at) {
  const std::vector<Index> known = known_places(mesh, first_at, at);
  for (const Index t : open) {
    if (is_charted(at[t])) continue;
    Index place = kUncharted;
    for (const Index v : mesh.faces[t])
      if (place == kUncharted) place = known[v];
    at[t] = {place, place, place};
  }
}

}  // namespace

void place_set_aside(const Surface& surface, const charts::Charts& whole,
                     const std::stop_token& stop, std::vector<Triangle>& at) {
  if (whole.set_aside.empty()) return;
  const TriMesh& mesh = surface.mesh;
  std::vector<Index> degenerate;
  for (std::size_t k = 0; k < whole.set_aside.size(); ++k)
    if (whole.repeats[k] == kNoFace) degenerate.push_back(whole.set_aside[k]);
  if (!degenerate.empty()) {
    const std::vector<Index> first_at = weld(mesh.positions, stop);
    EdgeBorrower borrower(mesh, degenerate, at);
    borrower.borrow(mesh.faces, stop);
    borrower.borrow(renumber(mesh.faces, first_at), stop);
    lay_on_points(mesh, degenerate, first_at, at);
  }
  for (std::size_t k = 0; k < whole.set_aside.size(); ++k)
    if (const Index original = whole.repeats[k]; original != kNoFace)
      at[whole.set_aside[k]] = corners_like(surface, whole.set_aside[k], original, at[original]);
}

}  // namespace unwrapd::pipeline
