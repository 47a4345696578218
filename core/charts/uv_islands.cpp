// Corners are sorted by position, UV and material, so that equal ones are neighbours. Islands are
// the sets that faces join them to (union-find, Tarjan 1975). Faces on top of each other stay
// there, since an artist who mirrored half a model meant it.
#include "core/charts/uv_islands.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>

#include "core/mesh/cross.hpp"
#include "core/mesh/disjoint_sets.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::charts {
namespace {

constexpr Index kNone = -1;

bool has_uvs(const CornerUv& uv) {
  return std::all_of(uv.begin(), uv.end(), [](const Vec2& u) { return u.allFinite(); });
}

/// Pairs of a position and a UV, numbered in the order of their first corners.
struct Places {
  std::vector<Triangle> of_corner;  ///< [face]; kNone if it has no UVs
  UvMap uv;
  std::vector<Vec3> position;
};

Places find_places(const Surface& surface) {
  const std::vector<Index> welded = weld(surface.mesh.positions);
  const auto material_of = [&](Index face) {
    return surface.materials.empty() ? std::string_view()
                                     : std::string_view(surface.materials[surface.part[face]]);
  };
  struct Corner {
    Index vertex;
    double u, v;
    std::string_view material;
    Index at;
    auto key() const { return std::tuple(vertex, u, v, material); }
  };
  std::vector<Corner> corners;
  for (Index c = 0; c < static_cast<Index>(3 * surface.mesh.faces.size()); ++c) {
    const CornerUv& uv = surface.corner_uv[c / 3];
    if (has_uvs(uv))
      corners.push_back({welded[surface.mesh.faces[c / 3][c % 3]], uv[c % 3].x(), uv[c % 3].y(),
                         material_of(c / 3), c});
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.key() < b.key(); });
  std::vector<Index> first(3 * surface.mesh.faces.size(), kNone);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const bool is_new = k == 0 || corners[k].key() != corners[k - 1].key();
    first[corners[k].at] = is_new ? corners[k].at : first[corners[k - 1].at];
  }
  Places places{std::vector<Triangle>(surface.mesh.faces.size(), {kNone, kNone, kNone}), {}, {}};
  for (Index c = 0; c < static_cast<Index>(first.size()); ++c) {
    if (first[c] == kNone) continue;
    Index& place = places.of_corner[c / 3][c % 3];
    if (first[c] != c) {
      place = places.of_corner[first[c] / 3][first[c] % 3];
      continue;
    }
    place = static_cast<Index>(places.uv.size());
    places.uv.push_back(surface.corner_uv[c / 3][c % 3]);
    places.position.push_back(surface.mesh.positions[surface.mesh.faces[c / 3][c % 3]]);
  }
  return places;
}

/// island[place], numbered in the order of the faces.
std::vector<Index> number_islands(const Places& places, Index& count) {
  DisjointSets joined(places.uv.size());
  for (const Triangle& face : places.of_corner)
    for (std::size_t i = 1; i < 3 && face[0] != kNone; ++i) joined.join(face[i], face[0]);
  std::vector<Index> of_root(places.uv.size(), kNone), island(places.uv.size());
  count = 0;
  for (Index p = 0; p < static_cast<Index>(island.size()); ++p) {
    Index& number = of_root[joined.root(p)];
    if (number == kNone) number = count++;
    island[p] = number;
  }
  return island;
}

double signed_area(const Triangle& face, const UvMap& uv) {
  return cross(uv[face[1]] - uv[face[0]], uv[face[2]] - uv[face[0]]);
}

using Side = std::array<Index, 2>;

/// The sides without an opposite side, if each vertex is the start of at most one of them.
std::vector<Side> border_of(const std::vector<Triangle>& faces) {
  std::vector<Side> sides;
  for (const Triangle& face : faces)
    for (std::size_t i = 0; i < 3; ++i) sides.push_back({face[i], face[(i + 1) % 3]});
  std::sort(sides.begin(), sides.end());
  std::vector<Side> border;
  for (const Side& side : sides)
    if (!std::binary_search(sides.begin(), sides.end(), Side{side[1], side[0]}))
      border.push_back(side);
  const bool branches =
      std::adjacent_find(border.begin(), border.end(),
                         [](const Side& a, const Side& b) { return a[0] == b[0]; }) != border.end();
  if (branches) border.clear();
  return border;
}

Outline loops_of(const std::vector<Side>& border, const UvMap& uv) {
  Outline outline;
  std::vector<char> is_used(border.size(), 0);
  for (std::size_t first = 0; first < border.size(); ++first)
    for (std::size_t k = first; is_used[k] == 0;) {
      is_used[k] = 1;
      outline.push_back({uv[border[k][0]], uv[border[k][1]]});
      const auto next = std::lower_bound(border.begin(), border.end(), Side{border[k][1], 0});
      if (next == border.end() || (*next)[0] != border[k][1]) break;
      k = static_cast<std::size_t>(next - border.begin());
    }
  return outline;
}

/// The border if all faces have the same orientation; else every face, counter-clockwise.
Outline cover_of(const std::vector<Triangle>& faces, const UvMap& uv) {
  const auto is_up = [&](const Triangle& face) { return signed_area(face, uv) > 0; };
  const auto up = std::count_if(faces.begin(), faces.end(), is_up);
  const auto down = std::count_if(faces.begin(), faces.end(),
                                  [&](const Triangle& face) { return signed_area(face, uv) < 0; });
  if (up == 0 || down == 0)
    if (Outline border = loops_of(border_of(faces), uv); !border.empty()) return border;
  Outline outline;
  for (const Triangle& face : faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 &a = uv[face[i]], &b = uv[face[(i + 1) % 3]];
      outline.push_back(is_up(face) ? std::array{a, b} : std::array{b, a});
    }
  return outline;
}

}  // namespace

UvIslands uv_islands(const Surface& surface) {
  UvIslands islands;
  islands.charts.input.faces = surface.mesh.face_count();
  islands.charts.input.vertices = surface.mesh.vertex_count();
  if (surface.corner_uv.empty()) return islands;
  const Places places = find_places(surface);
  Index count = 0;
  const std::vector<Index> island = number_islands(places, count);
  islands.charts.charts.resize(count);
  islands.maps.resize(count);
  std::vector<Index> local(places.uv.size());
  for (std::size_t p = 0; p < local.size(); ++p) {
    local[p] = static_cast<Index>(islands.maps[island[p]].size());
    islands.maps[island[p]].push_back(places.uv[p]);
    islands.charts.charts[island[p]].mesh.positions.push_back(places.position[p]);
  }
  for (std::size_t t = 0; t < places.of_corner.size(); ++t) {
    const auto& [a, b, c] = places.of_corner[t];
    if (a == kNone) {
      islands.charts.set_aside.push_back(static_cast<Index>(t));
      islands.charts.repeats.push_back(kNoFace);
      continue;
    }
    Chart& chart = islands.charts.charts[island[a]];
    chart.mesh.faces.push_back({local[a], local[b], local[c]});
    chart.face_source.push_back(static_cast<Index>(t));
  }
  for (std::size_t k = 0; k < islands.maps.size(); ++k)
    islands.outlines.push_back(cover_of(islands.charts.charts[k].mesh.faces, islands.maps[k]));
  return islands;
}

}  // namespace unwrapd::charts
