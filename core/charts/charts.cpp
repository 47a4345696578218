// Prepares a surface: weld vertices, set bad faces aside, pair half-edges, separate components,
// cut. The welding and the faces without area determine all the rest but the order of boundaries.
// The rest is cached for other meshes of the same faces.
#include "core/charts/charts.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/cut.hpp"
#include "core/charts/path_edges.hpp"
#include "core/charts/pieces.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/seams.hpp"
#include "core/mesh/weld.hpp"
#include "core/solve/base/cached.hpp"

namespace unwrapd::charts {
namespace {

constexpr Index kUnnumbered = -1;

void require_two_sides(const SurfaceNumbers& surface, const Pieces& pieces) {
  const auto component = one_sided_component(pieces.clashes, pieces.topology);
  if (!component) return;
  const auto& of = pieces.topology.component_of;
  const auto face = std::find(of.begin(), of.end(), *component) - of.begin();
  throw Error(ErrorCode::not_orientable,
              "The component of face " + std::to_string(pieces.source[face]) +
                  " is one-sided like a Moebius strip and has no consistent orientation; cut it "
                  "open, or send it with a cut and seams=keep.",
              std::string(surface.name));
}

/// The mesh whose vertices the twins imply; position(h) is the start of half-edge h.
template <class Position>
TriMesh mesh_of(const Halfedges& halfedges, Position position) {
  CornerVertices corners = corner_vertices(halfedges);
  TriMesh mesh{std::vector<Vec3>(corners.count), std::move(corners.faces)};
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h)
    mesh.positions[mesh.faces[h / 3][h % 3]] = position(h);
  return mesh;
}

/// Whether two materials meet at the edge of these half-edges, or the input has separate vertices
/// on its sides, for normals or texture coordinates.
bool is_crease(const SurfaceNumbers& surface, Index g, Index h) {
  const std::span<const Triangle> faces = surface.faces;
  return surface.part[face_of(g)] != surface.part[face_of(h)] ||
         start_of(faces, g) != end_of(faces, h) || end_of(faces, g) != start_of(faces, h);
}

/// The components of a surface, which depend on its vertices' positions only through coinciding
/// vertices and faces without area.
struct ConnectedSurface {
  Charts charts;                                  ///< without positions; loops in any order
  std::vector<std::vector<Index>> vertex_source;  ///< of each chart: the surface's vertices
};

std::size_t bytes_of(const ConnectedSurface& connected) {
  using unwrapd::solve::bytes_of;
  const Charts& charts = connected.charts;
  std::size_t bytes = solve::bytes_of(charts.set_aside) + solve::bytes_of(charts.repeats);
  bytes += solve::bytes_of(*charts.by_position);
  for (const std::vector<Index>& source : connected.vertex_source) bytes += solve::bytes_of(source);
  for (const Chart& chart : charts.charts) bytes += bytes_of(chart);
  return bytes;
}

/// The faces of one component.
struct Members {
  std::span<const Index> source;  ///< face numbers in pieces
  std::span<const Index> rank;    ///< rank[f]: the place in source of face f of pieces
};

void mark_creases(const SurfaceNumbers& surface, const Pieces& pieces, const Members& members,
                  const std::stop_token& stop, Chart& chart) {
  const auto given = [&](Index g) { return 3 * pieces.source[g / 3] + g % 3; };
  for (const Index t : members.source) {
    check_cancelled_every(members.rank[t], stop);
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = pieces.halfedges.twin[h];
      if (twin != kNoTwin && is_crease(surface, given(h), given(twin)))
        chart.crease[3 * members.rank[t] + h % 3] = 1;
    }
  }
}

/// Numbers the chart's vertices by first use. number: of the vertices of pieces, kUnnumbered if
/// not numbered yet. vertex_source: set for each of the chart's vertices.
void number_vertices(const SurfaceNumbers& surface, const Pieces& pieces, const Members& members,
                     std::vector<Index>& number, std::vector<Index>& vertex_source, Chart& chart) {
  chart.mesh.faces.resize(members.source.size());
  for (std::size_t k = 0; k < members.source.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) {
      Index& own = number[pieces.corners.faces[members.source[k]][i]];
      if (own == kUnnumbered) {
        own = static_cast<Index>(vertex_source.size());
        vertex_source.push_back(0);
      }
      chart.mesh.faces[k][i] = own;
      vertex_source[own] = surface.faces[chart.face_source[k]][i];
    }
}

Chart chart_of(const SurfaceNumbers& surface, const Pieces& pieces, const Members& members,
               const std::stop_token& stop) {
  Chart chart;
  const std::size_t count = members.source.size();
  chart.face_source.resize(count);
  chart.halfedges.twin.resize(3 * count);
  chart.crease.assign(3 * count, 0);
  for (std::size_t k = 0; k < count; ++k) {
    check_cancelled_every(k, stop);
    const Index t = members.source[k];
    chart.face_source[k] = pieces.source[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const Index twin = pieces.halfedges.twin[3 * t + i];
      chart.halfedges.twin[3 * k + i] =
          twin == kNoTwin ? kNoTwin : 3 * members.rank[twin / 3] + twin % 3;
    }
  }
  if (pieces.may_crease) mark_creases(surface, pieces, members, stop, chart);
  chart.loops = boundary_loops(chart.halfedges, stop);
  return chart;
}

void separate(const SurfaceNumbers& surface, const Pieces& pieces, const std::stop_token& stop,
              ConnectedSurface& out) {
  const auto& components = pieces.topology.components;
  const auto& of = pieces.topology.component_of;
  std::vector<Index> order(pieces.source.size());
  for (std::size_t t = 0; t < order.size(); ++t) order[t] = static_cast<Index>(t);
  counting_sort(
      order, static_cast<Index>(components.size()), [&](Index t) { return of[t]; }, stop);
  out.charts.charts.reserve(components.size());
  out.vertex_source.resize(components.size());
  std::vector<Index> rank(order.size()), number(pieces.corners.count, kUnnumbered);
  std::size_t first = 0;
  for (std::size_t k = 0; k < components.size(); ++k) {
    const std::span<const Index> source(order.data() + first, components[k].faces);
    for (std::size_t i = 0; i < source.size(); ++i) rank[source[i]] = static_cast<Index>(i);
    first += source.size();
    Chart chart = chart_of(surface, pieces, {source, rank}, stop);
    number_vertices(surface, pieces, {source, rank}, number, out.vertex_source[k], chart);
    out.charts.charts.push_back(std::move(chart));
    throw_if_cancelled(stop);
  }
}

InputReport input_report(const SurfaceNumbers& surface, const Topology& shape, bool welded) {
  InputReport input{.faces = static_cast<Index>(surface.faces.size()),
                    .vertices = surface.vertex_count};
  input.components = static_cast<Index>(shape.components.size());
  for (const Component& component : shape.components) {
    input.boundaries += component.boundaries;
    input.genus += component.genus;
  }
  input.welded = welded;
  return input;
}

std::vector<Repair> repairs_of(const FaceStates& states, const Pieces& pieces) {
  const auto faces = [&](FaceState state) {
    return static_cast<Index>(std::count(states.of.begin(), states.of.end(), state));
  };
  std::vector<Repair> repairs{
      {RepairKind::degenerate_faces_set_aside, 0,
       faces(FaceState::collapsed) + faces(FaceState::flat)},
      {RepairKind::duplicate_faces_set_aside, 0, faces(FaceState::duplicate)},
      {RepairKind::non_manifold_edges_split, 0, pieces.split_edges}};
  std::erase_if(repairs, [](const Repair& repair) { return repair.count == 0; });
  return repairs;
}

ConnectedSurface connect(const InspectedSurface& in, const SeamRules& seams) {
  const SurfaceNumbers& surface = in.surface;
  Pairing by_place = pair_welded(surface, in.welded, in.states, in.flat, seams.stop);
  const auto [pieces, was_welded] = choose_pieces(in, by_place, seams);
  require_two_sides(surface, pieces);
  throw_if_cancelled(seams.stop);
  ConnectedSurface connected;
  Charts& charts = connected.charts;
  separate(surface, pieces, seams.stop, connected);
  for (std::size_t t = 0; t < in.states.of.size(); ++t) {
    if (in.states.of[t] == FaceState::sound) continue;
    charts.set_aside.push_back(static_cast<Index>(t));
    charts.repeats.push_back(in.states.same_as[t]);
  }
  charts.input = input_report(surface, pieces.topology, was_welded);
  charts.repairs = repairs_of(in.states, pieces);
  const bool is_by_position = charts.set_aside.empty() && !by_place.pairs_sheets;
  charts.by_position = std::make_shared<const Halfedges>(
      is_by_position ? std::move(by_place.halfedges)
                     : build_halfedges(in.welded, surface.vertex_count, seams.stop));
  return connected;
}

/// Computes the components of a surface. areas, flat: see flat_pairs(). Duplicates are found here.
ConnectedSurface connect_surface(const solve::CacheContext&, const SurfaceNumbers& surface,
                                 std::span<const Index> first_at,
                                 const std::vector<FaceState>& areas,
                                 const std::vector<HalfedgePair>& flat, const SeamRules& seams) {
  const std::vector<Triangle> welded = renumber(surface.faces, first_at);
  FaceStates states{areas, std::vector<Index>(areas.size(), kNoFace)};
  find_duplicates(welded, surface.vertex_count, seams.stop, states);
  return connect({surface, first_at, welded, states, flat}, seams);
}

Charts placed(const ConnectedSurface& connected, const Surface& surface,
              std::span<const Triangle> welded, std::span<const EdgeEnds> kept,
              const std::stop_token& stop) {
  Charts charts = connected.charts;
  charts.scale = surface.scale;
  for (std::size_t k = 0; k < charts.charts.size(); ++k) {
    throw_if_cancelled(stop);
    Chart& chart = charts.charts[k];
    chart.mesh.positions.reserve(connected.vertex_source[k].size());
    for (const Index v : connected.vertex_source[k])
      chart.mesh.positions.push_back(surface.mesh.positions[v]);
    sort_by_length(chart.mesh, chart.loops);
    chart.avoid = avoid_of(chart, surface);
    if (!kept.empty()) mark_kept(welded, kept, chart);
  }
  return charts;
}

}  // namespace

bool is_disk(const Chart& component) {
  std::size_t sides = 0;  // number of boundary half-edges
  for (const BoundaryLoop& loop : component.loops) sides += loop.size();
  const Index faces = component.mesh.face_count();
  const Index edges = (3 * faces + static_cast<Index>(sides)) / 2;
  const Index euler = component.mesh.vertex_count() - edges + faces;
  const auto boundaries = static_cast<Index>(component.loops.size());
  return boundaries > 0 && euler == 2 - boundaries;
}

void cut(Chart& component) {
  cut_to_disk(component.mesh, component.halfedges, component.avoid);
  const TriMesh closed = std::move(component.mesh);
  component.mesh = mesh_of(component.halfedges,
                           [&](Index h) { return closed.positions[closed.faces[h / 3][h % 3]]; });
  component.loops = boundary_loops(component.mesh, component.halfedges);
}

Charts make_charts(const Surface& surface, SeamMode seams) {
  Charts charts = components_of(surface, {seams});
  Index count = 0;
  for (Chart& component : charts.charts) {
    if (is_disk(component)) continue;
    cut(component);
    ++count;
  }
  if (count > 0) charts.repairs.push_back({RepairKind::cut_to_disk, 0, count});
  return charts;
}

/// Only the paths on this surface count, and not its number among others. Edges are kept in what
/// is made of connected surfaces.
void describe(CacheKey& key, const SeamRules& seams) {
  const auto& [mode, paths, surface, stop, core, kept] = seams;
  static_cast<void>(kept), static_cast<void>(stop), static_cast<void>(core);
  key.add(mode);
  for (const SeamPath& path : paths)
    if (path.surface == surface) key.add(path.vertices);
}

Charts components_of(const Surface& surface, const SeamRules& seams) {
  assert(surface.part.size() == surface.mesh.faces.size());
  const std::vector<Index> first_at = weld(surface.mesh.positions, seams.stop);
  throw_if_cancelled(seams.stop);
  const std::vector<Triangle> welded = renumber(surface.mesh.faces, first_at);
  const std::vector<EdgeEnds> kept = kept_edges(seams, first_at, welded);
  const FaceStates states = inspect_areas(surface.mesh, welded, seams.stop);
  const auto flat = flat_pairs(surface.mesh.positions, welded, states.of, seams.stop);
  throw_if_cancelled(seams.stop);
  const auto pieces =
      solve::cached<connect_surface>(solve::CacheContext{seams.core, seams.stop},
                                     SurfaceNumbers(surface), first_at, states.of, flat, seams);
  return placed(*pieces, surface, welded, kept, seams.stop);
}

std::size_t bytes_of(const Chart& chart) {
  std::size_t bytes = sizeof(Chart) + solve::bytes_of(chart.mesh.positions) +
                      solve::bytes_of(chart.mesh.faces) + solve::bytes_of(chart.halfedges) +
                      solve::bytes_of(chart.face_source) + solve::bytes_of(chart.start) +
                      solve::bytes_of(chart.crease) + solve::bytes_of(chart.avoid);
  for (const BoundaryLoop& loop : chart.loops)
    bytes += sizeof(BoundaryLoop) + solve::bytes_of(loop);
  return bytes;
}

}  // namespace unwrapd::charts
