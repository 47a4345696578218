// A surface is copied only if it needs a repair. Winding is made consistent after welding, which
// tells what faces are neighbours.
#include "core/charts/repair_surfaces.hpp"

#include <algorithm>
#include <utility>

#include "core/mesh/orient_faces.hpp"
#include "core/mesh/weld.hpp"
#include "core/mesh/weld_near.hpp"

namespace unwrapd::charts {
namespace {

/// The faces over welded vertices, and their edges.
struct Connected {
  std::vector<Triangle> faces;
  FaceStates states;
  std::vector<EdgeSide> sides;
};

Connected connect(const TriMesh& mesh, std::span<const Index> first_at,
                  const std::stop_token& stop) {
  Connected connected{renumber(mesh.faces, first_at), {}, {}};
  connected.states = inspect_areas(mesh, connected.faces, stop);
  const auto is_sound = [&](Index h) {
    return connected.states.of[face_of(h)] == FaceState::sound;
  };
  connected.sides = edge_sides(connected.faces, is_sound, stop);
  sort_by_edge(connected.sides, mesh.vertex_count(), stop);
  return connected;
}

/// What a surface needs; both are empty if it needs nothing.
struct Needs {
  std::vector<Index> place;  ///< of a vertex: the vertex whose position it gets
  std::vector<char> turned;
};

/// The tolerance of weld_near().
std::optional<double> tolerance_of(const Welding& welding) {
  return welding.mode == WeldMode::distance ? welding.distance : std::nullopt;
}

/// The same sides over other vertices. The faces that were sound still are.
void renumber_sides(const TriMesh& mesh, std::span<const Index> place, const std::stop_token& stop,
                    Connected& connected) {
  connected.faces = renumber(mesh.faces, place);
  for (EdgeSide& side : connected.sides) side = side_of(connected.faces, side.halfedge);
  std::ranges::sort(connected.sides, {}, &EdgeSide::halfedge);
  sort_by_edge(connected.sides, mesh.vertex_count(), stop);
}

Needs needs_of(const Surface& surface, const Welding& welding, const std::stop_token& stop) {
  const TriMesh& mesh = surface.mesh;
  Needs needs;
  std::vector<Index> first_at = weld(mesh.positions, stop);
  Connected connected = connect(mesh, first_at, stop);
  const WeldedFaces exact{mesh, connected.faces, connected.states, connected.sides};
  std::vector<Index> near;
  if (welding.mode != WeldMode::exact) near = weld_near(exact, tolerance_of(welding), stop);
  if (!near.empty()) {
    for (Index& v : first_at) v = near[v];
    renumber_sides(mesh, first_at, stop, connected);
    needs.place = std::move(first_at);
  }
  needs.turned = faces_to_turn({mesh, connected.faces, connected.states, connected.sides}, stop);
  return needs;
}

/// The number of positions that get another one.
Index count_moved(std::span<const Index> place, const TriMesh& mesh) {
  const std::vector<Index> first_at = weld(mesh.positions);
  Index count = 0;
  for (Index v = 0; v < static_cast<Index>(place.size()); ++v)
    count += first_at[v] == v && place[v] != v ? 1 : 0;
  return count;
}

void turn_faces(std::span<const char> turned, Surface& surface) {
  for (std::size_t t = 0; t < turned.size(); ++t) {
    if (turned[t] == 0) continue;
    std::swap(surface.mesh.faces[t][1], surface.mesh.faces[t][2]);
    if (!surface.corner_uv.empty()) std::swap(surface.corner_uv[t][1], surface.corner_uv[t][2]);
  }
}

void repair(const Needs& needs, Index number, Surface& surface, std::vector<Repair>& repairs) {
  if (!needs.place.empty()) {
    const Index count = count_moved(needs.place, surface.mesh);
    repairs.push_back({RepairKind::vertices_welded_near, number, count});
    const std::vector<Vec3> given = surface.mesh.positions;
    for (std::size_t v = 0; v < given.size(); ++v)
      surface.mesh.positions[v] = given[needs.place[v]];
  }
  if (needs.turned.empty()) return;
  const auto count = std::count(needs.turned.begin(), needs.turned.end(), 1);
  repairs.push_back({RepairKind::faces_turned, number, static_cast<Index>(count)});
  turn_faces(needs.turned, surface);
}

}  // namespace

RepairedSurfaces repair_surfaces(std::span<const Surface> surfaces, const Welding& welding,
                                 const std::stop_token& stop) {
  RepairedSurfaces repaired{surfaces, {}, {}, {}};
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    Needs needs = needs_of(surfaces[s], welding, stop);
    if (!needs.place.empty() || !needs.turned.empty()) {
      if (repaired.changed.empty()) repaired.changed.assign(surfaces.begin(), surfaces.end());
      repair(needs, static_cast<Index>(s), repaired.changed[s], repaired.repairs);
      repaired.surfaces = repaired.changed;
    }
    repaired.turned.push_back(std::move(needs.turned));
  }
  return repaired;
}

void exchange_winding(const RepairedSurfaces& repaired, std::vector<UnwrappedSurface>& unwrapped) {
  for (std::size_t s = 0; s < unwrapped.size(); ++s)
    for (std::size_t t = 0; t < repaired.turned[s].size(); ++t)
      if (repaired.turned[s][t] != 0) std::swap(unwrapped[s].faces[t][1], unwrapped[s].faces[t][2]);
}

}  // namespace unwrapd::charts
