// A surface taken apart: weld, set bad faces aside, pair half-edges, separate components, cut.
//
// SeamMode::automatic keeps the surface's own cuts when they make it a few disks: that is what
// someone did who opened a model on purpose. A flat-shaded export or a triangle soup is hundreds of
// tiny "disks", and a model with the seams of an old atlas is many more than it has components;
// both are welded. The bounds below part the two by a wide margin.
#include "core/atlas/charts.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/atlas/cut.hpp"
#include "core/cancel.hpp"
#include "core/error.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/seams.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kMostKeptDisks = 64;           // in all
constexpr std::size_t kMostKeptDisksAComponent = 4;  // for each component of the welded surface
constexpr std::size_t kLeastFacesADisk = 8;          // on average

/// The sound faces of a surface and how they hang together.
struct Pieces {
  std::vector<Index> source;  ///< face -> face of the surface
  Halfedges halfedges;
  Topology topology;
  Index split_edges = 0;
  std::vector<std::array<Index, 2>> clashes;
};

/// Leaves out the faces that are set aside.
Pieces pieces_of(Pairing pairing, const FaceStates& states, const std::stop_token& stop) {
  throw_if_cancelled(stop);
  Pieces pieces;
  std::vector<Index> rank(states.of.size(), kNoFace);
  for (std::size_t t = 0; t < states.of.size(); ++t) {
    if (states.of[t] != FaceState::sound) continue;
    rank[t] = static_cast<Index>(pieces.source.size());
    pieces.source.push_back(static_cast<Index>(t));
  }
  const auto moved = [&](Index h) { return h == kNoTwin ? kNoTwin : 3 * rank[h / 3] + h % 3; };
  pieces.halfedges.twin.resize(3 * pieces.source.size());
  for (std::size_t h = 0; h < pieces.halfedges.twin.size(); ++h)
    pieces.halfedges.twin[h] = moved(pairing.halfedges.twin[3 * pieces.source[h / 3] + h % 3]);
  close_slits(pieces.halfedges);
  throw_if_cancelled(stop);
  pieces.topology = topology(corner_vertices(pieces.halfedges).faces, pieces.halfedges);
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

/// A surface with what weld() and inspect_faces() say of it.
struct Inspected {
  const Surface& surface;
  std::span<const Index> first_at;
  std::span<const Triangle> welded;
  const FaceStates& states;
};

[[noreturn]] void refuse_path(std::size_t path, const std::string& why) {
  throw Error(ErrorCode::invalid_option, "seam_edges: " + why,
              "/seam_edges/" + std::to_string(path));
}

std::string text(const EdgeEnds& edge) {
  return std::to_string(edge[0]) + " and " + std::to_string(edge[1]);
}

/// The edges of one path, in ascending order, over welded vertices.
std::vector<EdgeEnds> edges_of(const Inspected& in, const SeamPath& path, std::size_t number) {
  const auto count = static_cast<Index>(in.first_at.size());
  std::vector<EdgeEnds> edges;
  for (std::size_t k = 0; k < path.vertices.size(); ++k) {
    const Index v = path.vertices[k];
    if (v < 0 || v >= count)
      refuse_path(number, "there is no vertex " + std::to_string(v) + " in a mesh of " +
                              std::to_string(count) + "; give vertices of this mesh");
    if (k == 0) continue;
    const auto ends = std::minmax(in.first_at[path.vertices[k - 1]], in.first_at[v]);
    edges.push_back({ends.first, ends.second});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

void cut_paths(const Inspected& in, const SeamRules& seams, Halfedges& halfedges) {
  for (std::size_t k = 0; k < seams.paths.size(); ++k) {
    if (seams.paths[k].surface != seams.surface) continue;
    const std::vector<EdgeEnds> edges = edges_of(in, seams.paths[k], k);
    if (const auto missing = cut_edges(in.welded, edges, halfedges))
      refuse_path(k, "no edge joins vertices " + text(*missing) +
                         "; give vertices that follow each other along edges");
  }
}

Pieces welded_pieces(const Inspected& in, const SeamRules& seams) {
  Pairing pairing = pair_welded(in.welded, in.states);
  if (seams.mode == SeamMode::uv0 && !in.surface.corner_uv.empty())
    cut_at_uv_seams(in.surface, pairing.halfedges);
  cut_paths(in, seams, pairing.halfedges);
  return pieces_of(std::move(pairing), in.states, seams.stop);
}

Pieces kept_pieces(const Inspected& in, const SeamRules& seams) {
  Pairing pairing = pair_keeping_seams(in.surface, in.welded, in.states);
  cut_paths(in, seams, pairing.halfedges);
  return pieces_of(std::move(pairing), in.states, seams.stop);
}

/// The pieces that the mode asks for, and whether vertices were welded for them.
std::pair<Pieces, bool> choose(const Inspected& in, const SeamRules& seams) {
  const bool nothing_to_weld = std::ranges::equal(in.welded, in.surface.mesh.faces);
  const bool by_uv = seams.mode == SeamMode::uv0 && !in.surface.corner_uv.empty();
  if (seams.mode == SeamMode::none || by_uv) return {welded_pieces(in, seams), !nothing_to_weld};
  if (seams.mode == SeamMode::keep || nothing_to_weld) return {kept_pieces(in, seams), false};
  Pieces with_cuts = kept_pieces(in, seams);
  throw_if_cancelled(seams.stop);
  Pieces without = welded_pieces(in, seams);
  const bool same = with_cuts.halfedges.twin == without.halfedges.twin;
  if (same || is_a_few_disks(with_cuts, without)) return {std::move(with_cuts), false};
  return {std::move(without), true};
}

void require_two_sides(const Surface& surface, const Pieces& pieces) {
  const auto component = one_sided_component(pieces.clashes, pieces.topology);
  if (!component) return;
  const auto& of = pieces.topology.component_of;
  const auto face = std::find(of.begin(), of.end(), *component) - of.begin();
  throw Error(ErrorCode::not_orientable,
              "The piece that face " + std::to_string(pieces.source[face]) +
                  " belongs to is one-sided like a Moebius strip and has no consistent "
                  "orientation; cut it open, or send it with seams=keep and its cut in place.",
              surface.name);
}

/// The mesh whose vertices the twins imply; position(h) is where half-edge h starts.
template <class Position>
TriMesh mesh_of(const Halfedges& halfedges, Position position) {
  CornerVertices corners = corner_vertices(halfedges);
  TriMesh mesh{std::vector<Vec3>(corners.count), std::move(corners.faces)};
  for (Index h = 0; h < static_cast<Index>(halfedges.twin.size()); ++h)
    mesh.positions[mesh.faces[h / 3][h % 3]] = position(h);
  return mesh;
}

/// Whether materials meet between two half-edges of one edge, or the input has other vertices on
/// either side: of normals, or of texture coordinates.
bool is_crease(const Surface& surface, Index g, Index h) {
  const std::vector<Triangle>& faces = surface.mesh.faces;
  return surface.part[face_of(g)] != surface.part[face_of(h)] ||
         start_of(faces, g) != end_of(faces, h) || end_of(faces, g) != start_of(faces, h);
}

/// source: the chart's faces as numbers of pieces; rank: their place in source.
Chart chart_of(const Surface& surface, const Pieces& pieces, std::span<const Index> source,
               std::span<const Index> rank) {
  Chart chart;
  for (Index t : source) {
    chart.face_source.push_back(pieces.source[t]);
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = pieces.halfedges.twin[h];
      chart.halfedges.twin.push_back(twin == kNoTwin ? kNoTwin : 3 * rank[twin / 3] + twin % 3);
      const auto given = [&](Index g) { return 3 * pieces.source[g / 3] + g % 3; };
      chart.crease.push_back(twin != kNoTwin && is_crease(surface, given(h), given(twin)) ? 1 : 0);
    }
  }
  chart.mesh = mesh_of(chart.halfedges, [&](Index h) {
    return surface.mesh.positions[surface.mesh.faces[chart.face_source[h / 3]][h % 3]];
  });
  return chart;
}

std::vector<Chart> separate(const Surface& surface, const Pieces& pieces,
                            const std::stop_token& stop) {
  const auto& components = pieces.topology.components;
  const auto& of = pieces.topology.component_of;
  std::vector<Index> order(pieces.source.size());
  for (std::size_t t = 0; t < order.size(); ++t) order[t] = static_cast<Index>(t);
  counting_sort(order, static_cast<Index>(components.size()), [&](Index t) { return of[t]; });
  std::vector<Chart> charts;
  charts.reserve(components.size());
  std::vector<Index> rank(order.size());
  std::size_t first = 0;
  for (const Component& component : components) {
    throw_if_cancelled(stop);
    const std::span<const Index> source(order.data() + first, component.faces);
    for (std::size_t k = 0; k < source.size(); ++k) rank[source[k]] = static_cast<Index>(k);
    first += source.size();
    charts.push_back(chart_of(surface, pieces, source, rank));
    throw_if_cancelled(stop);
    charts.back().loops = boundary_loops(charts.back().mesh, charts.back().halfedges);
  }
  return charts;
}

InputReport input_report(const TriMesh& mesh, const Topology& shape, bool welded) {
  InputReport input{.faces = mesh.face_count(), .vertices = mesh.vertex_count()};
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

}  // namespace

bool is_disk(const Chart& component) {
  const Topology shape = topology(component.mesh.faces, component.halfedges);
  return shape.components.size() == 1 && shape.components.front().is_disk();
}

void cut(Chart& component) {
  cut_to_disk(component.mesh, component.halfedges);
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

Charts components_of(const Surface& surface, const SeamRules& seams) {
  assert(surface.part.size() == surface.mesh.faces.size());
  const std::vector<Index> first_at = weld(surface.mesh.positions);
  throw_if_cancelled(seams.stop);
  const std::vector<Triangle> welded = renumbered(surface.mesh.faces, first_at);
  const FaceStates states = inspect_faces(surface.mesh, welded);
  throw_if_cancelled(seams.stop);
  const auto [pieces, was_welded] = choose({surface, first_at, welded, states}, seams);
  require_two_sides(surface, pieces);
  throw_if_cancelled(seams.stop);
  Charts charts;
  charts.charts = separate(surface, pieces, seams.stop);
  for (std::size_t t = 0; t < states.of.size(); ++t) {
    if (states.of[t] == FaceState::sound) continue;
    charts.set_aside.push_back(static_cast<Index>(t));
    charts.repeats.push_back(states.same_as[t]);
  }
  charts.input = input_report(surface.mesh, pieces.topology, was_welded);
  charts.repairs = repairs_of(states, pieces);
  return charts;
}

}  // namespace unwrapd
