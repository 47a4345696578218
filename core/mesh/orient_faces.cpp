// The orientation of faces relative to each other is a union-find structure with a parity.
#include "core/mesh/orient_faces.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>

#include "core/mesh/counting_sort.hpp"
#include "core/mesh/parity_sets.hpp"

namespace unwrapd {
namespace {

constexpr Index kClearShare = 4;  // one face of so many may be wound the other way

/// Whether two faces meet at an edge, and are not one triangle with both orientations.
bool is_manifold(const WeldedFaces& in, const EdgeSide* first, const EdgeSide* last) {
  return last - first == 2 &&
         apex_of(in.faces, first[0].halfedge) != apex_of(in.faces, first[1].halfedge);
}

bool is_clash(const WeldedFaces& in, const EdgeSide& a, const EdgeSide& b) {
  return start_of(in.faces, a.halfedge) == start_of(in.faces, b.halfedge);
}

bool has_clash(const WeldedFaces& in, const std::stop_token& stop) {
  bool found = false;
  for_each_run(
      in.sides, on_one_edge,
      [&](const EdgeSide* first, const EdgeSide* last) {
        found = found || (is_manifold(in, first, last) && is_clash(in, first[0], first[1]));
      },
      stop);
  return found;
}

/// The faces that manifold edges connect, relative to their root.
struct Group {
  std::array<Index, 2> count{};  ///< faces with the winding of the root, and with the other one
  double volume = 0;             ///< signed, if all are wound as the root is
  bool is_closed = true;
  bool is_one_sided = false;
};

class Groups {
 public:
  Groups(const WeldedFaces& in, const std::stop_token& stop)
      : in_(in), sets_(in.faces.size()), of_(in.faces.size()), first_(in.faces.size(), kNoFace) {
    std::vector<Index> clashing, open;  // faces
    for_each_run(
        in.sides, on_one_edge,
        [&](const EdgeSide* first, const EdgeSide* last) {
          const Index a = face_of(first->halfedge);
          if (!is_manifold(in, first, last))
            for (const EdgeSide* s = first; s != last; ++s) open.push_back(face_of(s->halfedge));
          else if (!sets_.relate(a, face_of(first[1].halfedge), is_clash(in, first[0], first[1])))
            clashing.push_back(a);
        },
        stop);
    for (const Index t : open) group(t).is_closed = false;
    for (const Index t : clashing) group(t).is_one_sided = true;
    for (Index t = 0; t < static_cast<Index>(in.faces.size()); ++t) add(t);
  }

  /// Whether the face's winding is to be reversed.
  bool is_turned(Index face) {
    const auto [root, is_opposite] = sets_.find(face);
    const Group& own = of_[root];
    const auto [same, other] = own.count;
    if (own.is_one_sided || same == 0 || other == 0) return false;
    bool turns_root = other > same || (other == same && sets_.find(first_[root]).second);
    const bool is_clear = std::min(same, other) * kClearShare <= same + other;
    if (!is_clear && own.is_closed) turns_root = own.volume < 0;
    return is_opposite != turns_root;
  }

 private:
  Group& group(Index face) { return of_[sets_.find(face).first]; }

  void add(Index face) {
    if (in_.states.of[face] != FaceState::sound) return;
    const auto [root, is_opposite] = sets_.find(face);
    if (first_[root] == kNoFace) first_[root] = face;
    Group& own = of_[root];
    ++own.count[is_opposite ? 1 : 0];
    const auto at = [&](Index v) -> const Vec3& { return in_.mesh.positions[v]; };
    const Vec3& origin = at(in_.faces[root][0]);
    const auto& [a, b, c] = in_.faces[face];
    const double volume = (at(a) - origin).dot((at(b) - origin).cross(at(c) - origin));
    own.volume += is_opposite ? -volume : volume;
  }

  const WeldedFaces& in_;
  ParitySets sets_;
  std::vector<Group> of_;     // at the root
  std::vector<Index> first_;  // the first face of a group, at the root
};

}  // namespace

std::vector<char> faces_to_turn(const WeldedFaces& in, const std::stop_token& stop) {
  if (!has_clash(in, stop)) return {};
  Groups groups(in, stop);
  std::vector<char> turned(in.faces.size(), 0);
  bool any = false;
  for (Index t = 0; t < static_cast<Index>(turned.size()); ++t) {
    check_cancelled_every(t, stop);
    if (in.states.of[t] == FaceState::sound && groups.is_turned(t)) turned[t] = 1;
    any = any || turned[t] != 0;
  }
  return any ? turned : std::vector<char>{};
}

}  // namespace unwrapd
