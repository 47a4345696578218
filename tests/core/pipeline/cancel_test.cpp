// What takes time with the size of the mesh hears that it shall stop: each step by itself, since in
// a whole job the step before would have heard it.
#include <gtest/gtest.h>

#include <functional>

#include "core/base/error.hpp"
#include "core/charts/split_chart.hpp"
#include "core/linear/dominant_lu.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/measure/seam_length.hpp"
#include "core/measure/winding.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/seams.hpp"
#include "core/mesh/weld.hpp"
#include "core/pack/pack.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/segment/coarsen.hpp"
#include "core/segment/transfer_seams.hpp"
#include "core/solve/arap/even_boundary_scale_factors.hpp"
#include "core/solve/arap/face_blocks.hpp"
#include "core/solve/arap/initial_rotations.hpp"
#include "core/solve/base/metric.hpp"
#include "core/solve/maps/conformal_system.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "tests/core/linear/graphs.hpp"
#include "tests/core/linear/systems.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/ranks.hpp"

namespace unwrapd::pipeline {
namespace {

using Stop = const std::stop_token&;

struct Step {
  std::string name;
  std::function<void(Stop)> take;
};

void expect_all_to_hear(const std::vector<Step>& steps) {
  for (const auto& [name, take] : steps) {
    std::stop_source source;
    EXPECT_NO_THROW(take(source.get_token())) << name;
    source.request_stop();
    try {
      take(source.get_token());
      ADD_FAILURE() << name << " went on";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled) << name;
    }
  }
}

struct Sample {
  TriMesh mesh = shapes::grid(12, 12);
  Surface surface = shapes::surface_of(mesh);
  Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
  FaceStates states = inspect_faces(mesh, mesh.faces);
  shapes::OwnedDisk owned = shapes::disk_of(mesh);
  UvMap uv = shapes::from_above(mesh.positions);

  /// As in a job that may be told to stop.
  [[nodiscard]] solve::Disk disk(Stop stop) const {
    solve::Disk disk = owned.disk;
    disk.stop = stop;
    return disk;
  }
};

TEST(Cancel, IsHeardInTopology) {
  const Sample s;
  const TriMesh& mesh = s.mesh;
  expect_all_to_hear(
      {{"weld", [&](Stop stop) { weld(mesh.positions, stop); }},
       {"inspect", [&](Stop stop) { inspect_faces(mesh, mesh.faces, stop); }},
       {"pair", [&](Stop stop) { build_halfedges(mesh.faces, mesh.vertex_count(), stop); }},
       {"pair welded", [&](Stop stop) { pair_welded(s.surface, mesh.faces, s.states, {}, stop); }},
       {"keep seams",
        [&](Stop stop) { pair_keeping_seams(s.surface, mesh.faces, s.states, stop); }},
       {"slits",
        [&](Stop stop) {
          Halfedges own = s.halfedges;
          close_slits(own, stop);
        }},
       {"topology", [&](Stop stop) { topology(mesh.faces, s.halfedges, stop); }},
       {"vertices", [&](Stop stop) { corner_vertices(s.halfedges, stop); }},
       {"loops", [&](Stop stop) { boundary_loops(mesh, s.halfedges, stop); }},
       {"components", [&](Stop stop) {
          charts::components_of(s.surface, {SeamMode::automatic, {}, 0, stop});
        }}});
}

TEST(Cancel, IsHeardInLinearAlgebra) {
  const Sample s;
  const TriMesh& mesh = s.mesh;
  const linear::SparseMatrix lower = linear::arap_matrix(s.owned.disk);
  const linear::SparseMatrix dominant =
      linear::SparseMatrix(lower.selfadjointView<Eigen::Lower>()) +
      linear::SparseMatrix(Eigen::VectorXd::Ones(lower.cols()).asDiagonal());
  const linear::Graph graph = linear::graph_of(mesh);
  const std::vector<Index> order = linear::fill_reducing_order(graph);
  const std::vector<double> ones(3 * mesh.faces.size(), 1);
  expect_all_to_hear(
      {{"assembly",
        [&](Stop stop) { linear::lower_laplacian(mesh.faces, mesh.vertex_count(), ones, stop); }},
       {"corners",
        [&](Stop stop) { linear::vertex_corners(mesh.faces, mesh.vertex_count(), stop); }},
       {"graph",
        [&](Stop stop) {
          linear::graph_of_lower({lower.outerIndexPtr(), std::size_t(lower.cols()) + 1},
                                 {lower.innerIndexPtr(), std::size_t(lower.nonZeros())}, stop);
        }},
       {"order", [&](Stop stop) { linear::fill_reducing_order(graph, stop); }},
       {"tree", [&](Stop stop) { linear::elimination_tree(graph, order, stop); }},
       {"factor", [&](Stop stop) { linear::factor(lower, stop); }},
       {"L U", [&](Stop stop) {
          std::vector<Vec2> b(std::size_t(lower.cols()), Vec2(1, 2));
          linear::solve_dominant(dominant, b, stop);
        }}});
}

TEST(Cancel, IsHeardWhileMapsAreMade) {
  const Sample s;
  const solve::arap::GlobalStep global(s.owned.disk, {});
  const std::vector<Index> rank = shapes::as_listed(s.mesh.positions.size());
  const std::vector<double> curved(s.mesh.positions.size(), 1);
  expect_all_to_hear(
      {{"disk", [&](Stop stop) { solve::make_disk(s.mesh, s.owned.disk.loops, stop); }},
       {"flatten", [&](Stop stop) { measure::flatten(s.mesh, stop); }},
       {"curvature", [&](Stop stop) { solve::curvature(s.disk(stop), s.owned.disk.rest); }},
       {"level scales",
        [&](Stop stop) {
          solve::arap::even_boundary_scale_factors(s.disk(stop), global, curved, 99);
        }},
       {"frames", [&](Stop stop) { solve::arap::map_from_rotations(s.disk(stop), global); }},
       {"global step", [&](Stop stop) { solve::arap::GlobalStep(s.disk(stop), {}); }},
       {"Tutte", [&](Stop stop) { solve::maps::tutte_map(s.disk(stop)); }},
       {"mean value", [&](Stop stop) { solve::maps::mean_value_map(s.disk(stop)); }},
       {"blocks",
        [&](Stop stop) { solve::arap::face_blocks(s.owned.disk.rest, s.mesh.faces, rank, stop); }},
       {"conformal", [&](Stop stop) {
          solve::maps::ConformalSystem(s.disk(stop), {{{0, Vec2(0, 0)}, {5, Vec2(1, 0)}}, {}});
        }}});
}

TEST(Cancel, IsHeardWhileMapsAreMeasuredAndPutBack) {
  const Sample s;
  const charts::Charts charts = charts::make_charts(s.surface, SeamMode::keep);
  const UnwrappedSurface flat{s.mesh.faces, {}, s.uv};
  const std::vector<UvMap> maps{s.uv};
  const auto& faces = s.mesh.faces;
  expect_all_to_hear(
      {{"flips", [&](Stop stop) { measure::flipped_faces(faces, s.uv, stop); }},
       {"injective",
        [&](Stop stop) { measure::is_plainly_injective(faces, s.owned.disk.loops, s.uv, stop); }},
       {"overlaps", [&](Stop stop) { measure::overlapping_pairs(faces, s.uv, 9, stop); }},
       {"winding",
        [&](Stop stop) {
          measure::faces_perhaps_overlapped(faces, s.owned.disk.loops, s.uv, stop);
        }},
       {"distortion",
        [&](Stop stop) { measure::distortion_sums(s.owned.disk.rest, faces, s.uv, stop); }},
       {"assemble", [&](Stop stop) { assemble(s.surface, charts, maps, stop); }},
       {"seams", [&](Stop stop) { measure::seam_lengths(s.surface, flat, stop); }}});
}

TEST(Cancel, IsHeardWhereLargeSurfacesAreTakenApart) {
  const Sample s;
  const segment::Coarse coarse = segment::coarsen(s.mesh, s.halfedges, 60, {});
  const std::vector<char> seam(coarse.halfedges.twin.size(), 0);
  const charts::Chart& chart = *s.owned.chart;
  expect_all_to_hear(
      {{"coarsen", [&](Stop stop) { segment::coarsen(s.mesh, s.halfedges, 60, stop); }},
       {"transfer_seams",
        [&](Stop stop) { segment::transfer_seams(s.mesh, s.halfedges, coarse, seam, stop); }},
       {"parts", [&](Stop stop) { charts::parts_of(chart, chart.halfedges, stop); }},
       {"split", [&](Stop stop) {
          charts::split_chart(chart, {{{0}, {200}}}, stop);
        }}});
}

}  // namespace
}  // namespace unwrapd::pipeline
