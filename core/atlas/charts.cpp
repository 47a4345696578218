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
#include "core/error.hpp"
#include "core/mesh/counting_sort.hpp"
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
Pieces pieces_of(Pairing pairing, const FaceStates& states) {
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

/// The pieces that the mode asks for, and whether vertices were welded for them.
std::pair<Pieces, bool> choose(const Surface& surface, SeamMode seams,
                               std::span<const Triangle> welded_faces, const FaceStates& states) {
  const auto welded = [&] { return pieces_of(pair_welded(welded_faces, states), states); };
  const auto kept = [&] {
    return pieces_of(pair_keeping_seams(surface, welded_faces, states), states);
  };
  const bool nothing_to_weld = std::ranges::equal(welded_faces, surface.mesh.faces);
  if (seams == SeamMode::keep || nothing_to_weld) return {kept(), false};
  if (seams == SeamMode::none) return {welded(), true};
  Pieces with_cuts = kept();
  Pieces without = welded();
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

/// source: the chart's faces as numbers of pieces; rank: their place in source.
Chart chart_of(const Surface& surface, const Pieces& pieces, std::span<const Index> source,
               std::span<const Index> rank) {
  Chart chart;
  for (Index t : source) {
    chart.face_source.push_back(pieces.source[t]);
    for (Index h = 3 * t; h < 3 * t + 3; ++h) {
      const Index twin = pieces.halfedges.twin[h];
      chart.halfedges.twin.push_back(twin == kNoTwin ? kNoTwin : 3 * rank[twin / 3] + twin % 3);
    }
  }
  chart.mesh = mesh_of(chart.halfedges, [&](Index h) {
    return surface.mesh.positions[surface.mesh.faces[chart.face_source[h / 3]][h % 3]];
  });
  return chart;
}

void cut(Chart& chart) {
  cut_to_disk(chart.mesh, chart.halfedges);
  const TriMesh closed = std::move(chart.mesh);
  chart.mesh = mesh_of(chart.halfedges,
                       [&](Index h) { return closed.positions[closed.faces[h / 3][h % 3]]; });
}

[[maybe_unused]] bool is_disk(const Chart& chart) {
  const Topology shape = topology(chart.mesh.faces, chart.halfedges);
  return shape.components.size() == 1 && shape.components.front().is_disk();
}

std::vector<Chart> separate(const Surface& surface, const Pieces& pieces) {
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
    const std::span<const Index> source(order.data() + first, component.faces);
    for (std::size_t k = 0; k < source.size(); ++k) rank[source[k]] = static_cast<Index>(k);
    first += source.size();
    charts.push_back(chart_of(surface, pieces, source, rank));
    if (!component.is_disk()) cut(charts.back());
    charts.back().loops = boundary_loops(charts.back().mesh, charts.back().halfedges);
    assert(is_disk(charts.back()));
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
  const auto& components = pieces.topology.components;
  const auto cuts = std::count_if(components.begin(), components.end(),
                                  [](const Component& c) { return !c.is_disk(); });
  std::vector<Repair> repairs{
      {RepairKind::degenerate_faces_set_aside, 0,
       faces(FaceState::collapsed) + faces(FaceState::flat)},
      {RepairKind::duplicate_faces_set_aside, 0, faces(FaceState::duplicate)},
      {RepairKind::non_manifold_edges_split, 0, pieces.split_edges},
      {RepairKind::cut_to_disk, 0, static_cast<Index>(cuts)}};
  std::erase_if(repairs, [](const Repair& repair) { return repair.count == 0; });
  return repairs;
}

}  // namespace

Charts make_charts(const Surface& surface, SeamMode seams) {
  assert(surface.part.size() == surface.mesh.faces.size());
  const std::vector<Index> first_at = weld(surface.mesh.positions);
  const std::vector<Triangle> welded = renumbered(surface.mesh.faces, first_at);
  const FaceStates states = inspect_faces(surface.mesh, welded);
  const auto [pieces, was_welded] = choose(surface, seams, welded, states);
  require_two_sides(surface, pieces);
  Charts charts;
  charts.charts = separate(surface, pieces);
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
