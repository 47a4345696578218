#include "core/charts/constraints.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/charts/vertex_finder.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::charts {
namespace {

using shapes::surface_of;

struct Asset {
  std::vector<Surface> surfaces;
  std::vector<Charts> charts;
};

Asset asset_of(const std::vector<TriMesh>& meshes, SeamMode seams = SeamMode::automatic) {
  Asset asset;
  for (const TriMesh& mesh : meshes) {
    asset.surfaces.push_back(surface_of(mesh));
    asset.charts.push_back(make_charts(asset.surfaces.back(), seams));
  }
  return asset;
}

std::vector<std::vector<solve::VertexConstraints>> constrained(
    const Asset& asset, const std::vector<PositionConstraint>& constraints) {
  return page_constraints(asset.surfaces, asset.charts, constraints, {});
}

PositionConstraint pin(Index vertex, double u, double v) {
  return {.vertex = vertex, .uv = Vec2(u, v)};
}

PositionConstraint soft(Index vertex, double u, double v, double weight) {
  return {.vertex = vertex, .uv = Vec2(u, v), .weight = weight};
}

PositionConstraint at(const Vec3& position, double u, double v) {
  return {.position = position, .uv = Vec2(u, v)};
}

void expect_refused(const Asset& asset, const std::vector<PositionConstraint>& constraints,
                    const std::string& where, const std::string& words) {
  try {
    constrained(asset, constraints);
    FAIL() << "not refused: " << words;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_constraint);
    EXPECT_EQ(e.where(), where) << e.what();
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

/// Where in space the fixed vertices of a chart lie, and their UVs.
std::vector<std::pair<Vec3, Vec2>> places(const Chart& chart,
                                          const solve::VertexConstraints& constraints) {
  std::vector<std::pair<Vec3, Vec2>> found;
  for (const solve::HardConstraint& p : constraints.hard)
    found.emplace_back(chart.mesh.positions[std::size_t(p.vertex)], p.at);
  return found;
}

TEST(Constraints, HoldNothingWhenThereAreNone) {
  const Asset asset = asset_of({shapes::grid(2, 2), shapes::cube(1)});
  const auto constraints = constrained(asset, {});
  ASSERT_EQ(constraints.size(), 2U);
  for (const auto& of_surface : constraints)
    for (const solve::VertexConstraints& of_chart : of_surface) EXPECT_TRUE(of_chart.empty());
}

TEST(Constraints, HoldTheVertexThatTheyName) {
  const TriMesh mesh = shapes::shuffled(shapes::random_disk(6, 1), 2);
  const Asset asset = asset_of({mesh});
  const auto constraints =
      constrained(asset, {pin(7, 0.2, 0.3), pin(30, 0.8, 0.9), soft(11, 0.5, 0.4, 2)});
  const solve::VertexConstraints& own = constraints[0][0];
  ASSERT_EQ(own.hard.size(), 2U);
  for (const auto& [position, uv] : places(asset.charts[0].charts[0], own))
    EXPECT_EQ(position, mesh.positions[uv.x() == 0.2 ? 7 : 30]);
  ASSERT_EQ(own.soft.size(), 1U);
  EXPECT_EQ(asset.charts[0].charts[0].mesh.positions[std::size_t(own.soft[0].vertex)],
            mesh.positions[11]);
  EXPECT_EQ(own.soft[0].at, Vec2(0.5, 0.4));
  EXPECT_EQ(own.soft[0].weight, 2);
}

TEST(Constraints, ByPositionAreConstraintsByIndexOfTheNearestVertex) {
  const TriMesh mesh = shapes::random_disk(9, 5);
  const Asset asset = asset_of({mesh});
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> place(-0.2, 1.2);
  for (int k = 0; k < 300; ++k) {
    const Vec3 p(place(rng), place(rng), place(rng) / 2);
    Index nearest = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if ((mesh.positions[std::size_t(v)] - p).norm() <
          (mesh.positions[std::size_t(nearest)] - p).norm())
        nearest = v;
    const solve::VertexConstraints by_place = constrained(asset, {at(p, 0.1, 0.2)})[0][0];
    const solve::VertexConstraints by_index = constrained(asset, {pin(nearest, 0.1, 0.2)})[0][0];
    EXPECT_EQ(by_place.hard[0].vertex, by_index.hard[0].vertex);
  }
}

TEST(Constraints, TakeTheLowestVertexOfEquallyNearPlaces) {
  const TriMesh mesh = shapes::shuffled(shapes::grid(4, 4), 9);
  const Surface surface = surface_of(mesh);
  const VertexFinder finder(surface, make_charts(surface, SeamMode::automatic));
  const Vec3 middle(0.375, 0.375, 0);  // of a quad
  std::vector<Index> corners;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if ((mesh.positions[std::size_t(v)] - middle).norm() < 0.2) corners.push_back(v);
  ASSERT_EQ(corners.size(), 4U);
  EXPECT_EQ(finder.nearest(middle), corners.front());
}

TEST(Constraints, HoldOneVertexOfEveryChartAtThePlace) {
  const std::vector<TriMesh> two{shapes::grid(3, 3), shapes::moved(shapes::grid(3, 3), {1, 0, 0})};
  const Asset asset = asset_of({shapes::merged(two)}, SeamMode::keep);
  ASSERT_EQ(asset.charts[0].charts.size(), 2U);
  const auto constraints = constrained(asset, {at({1, 0, 0}, 0.3, 0.4)});
  for (std::size_t k : {0U, 1U}) {
    ASSERT_EQ(constraints[0][k].hard.size(), 1U);
    const auto [position, uv] = places(asset.charts[0].charts[k], constraints[0][k]).front();
    EXPECT_EQ(position, Vec3(1, 0, 0));
    EXPECT_EQ(uv, Vec2(0.3, 0.4));
  }
}

TEST(Constraints, HoldOneSideOfACut) {
  const TriMesh mesh = shapes::sphere(2);
  const Asset asset = asset_of({mesh});
  const Chart& chart = asset.charts[0].charts[0];
  ASSERT_GT(chart.mesh.vertex_count(), mesh.vertex_count());  // cut open
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const solve::VertexConstraints by_index = constrained(asset, {pin(v, 0.1, 0.2)})[0][0];
    const solve::VertexConstraints by_place =
        constrained(asset, {at(mesh.positions[std::size_t(v)], 0.1, 0.2)})[0][0];
    ASSERT_EQ(by_index.hard.size(), 1U);
    ASSERT_EQ(by_place.hard.size(), 1U);
    EXPECT_EQ(by_index.hard[0].vertex, by_place.hard[0].vertex);
    Index first = -1;  // what the lowest corner of v shows
    for (std::size_t t = 0; t < mesh.faces.size() && first < 0; ++t)
      for (std::size_t i = 0; i < 3; ++i)
        if (first < 0 && mesh.faces[t][i] == v) first = chart.mesh.faces[t][i];
    EXPECT_EQ(by_index.hard[0].vertex, first);
  }
}

TEST(Constraints, OfCopiesThatAreWeldedAreConstraintsOfOneVertex) {
  const TriMesh mesh = shapes::soup(shapes::grid(3, 3));
  const Asset asset = asset_of({mesh}, SeamMode::none);
  std::vector<PositionConstraint> all;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    all.push_back(pin(v, mesh.positions[std::size_t(v)].x(), mesh.positions[std::size_t(v)].y()));
  EXPECT_EQ(constrained(asset, all)[0][0].hard.size(), 16U);
}

TEST(Constraints, OfOneVertexAreMerged) {
  const Asset asset = asset_of({shapes::grid(2, 2)});
  const solve::VertexConstraints soft_ones =
      constrained(asset, {soft(3, 0, 0, 1), soft(4, 0.5, 0.5, 1), soft(3, 1, 0.5, 3)})[0][0];
  ASSERT_EQ(soft_ones.soft.size(), 2U);
  for (const solve::SoftConstraint& s : soft_ones.soft)
    if (s.weight != 1) {
      EXPECT_EQ(s.weight, 4);
      EXPECT_EQ(s.at, Vec2(0.75, 0.375));
    }
  const solve::VertexConstraints mixed =
      constrained(asset, {soft(3, 0, 0, 1), pin(3, 0.5, 0.5), pin(3, 0.5, 0.5)})[0][0];
  EXPECT_TRUE(mixed.soft.empty());
  ASSERT_EQ(mixed.hard.size(), 1U);
  EXPECT_EQ(mixed.hard[0].at, Vec2(0.5, 0.5));
}

TEST(Constraints, RefuseWhatDoesNotExist) {
  const Asset asset = asset_of({shapes::grid(2, 2)});
  PositionConstraint elsewhere = pin(0, 0, 0);
  for (Index surface : {-1, 1}) {
    elsewhere.surface = surface;
    expect_refused(asset, {pin(0, 0, 0), elsewhere}, "/constraints/1", "no mesh");
  }
  for (Index vertex : {-1, 9})
    expect_refused(asset, {pin(vertex, 0, 0)}, "/constraints/0", "no vertex");
  expect_refused(asset, {pin(0, 1e39, 0)}, "/constraints/0", "32-bit");
  for (double weight : {0.0, -1.0, 1e-10, 1e10, std::nan("")})
    expect_refused(asset, {soft(0, 0, 0, weight)}, "/constraints/0", "weight");
}

TEST(Constraints, RefuseVerticesThatNoTriangleUses) {
  TriMesh mesh = shapes::grid(2, 2);
  mesh.positions.emplace_back(0.5, 0.5, 9);
  mesh.positions.emplace_back(0.25, 0.25, 9);
  mesh.faces.push_back({9, 9, 10});  // degenerate: in no chart
  const Asset asset = asset_of({mesh, TriMesh{}});
  for (Index vertex : {9, 10})
    expect_refused(asset, {pin(vertex, 0, 0)}, "/constraints/0", "to no triangle");
  PositionConstraint nowhere = at({0, 0, 0}, 0, 0);
  nowhere.surface = 1;
  expect_refused(asset, {nowhere}, "/constraints/0", "no triangles");
  const solve::VertexConstraints near =
      constrained(asset, {at({0.5, 0.5, 9}, 0, 0)})[0][0];  // the unused one is not found
  EXPECT_EQ(places(asset.charts[0].charts[0], near)[0].first, Vec3(0.5, 0.5, 0));
}

TEST(Constraints, RefuseContradictions) {
  const Asset asset = asset_of({shapes::grid(2, 2)});
  expect_refused(asset, {pin(0, 0, 0), pin(4, 1, 1), pin(8, 0, 1), pin(4, 1, 0.5)},
                 "/constraints/3", "constraint 1 places the same vertex at (1, 1)");
  EXPECT_NO_THROW(constrained(asset, {pin(4, 1, 1), pin(4, 1, 1 + 1e-12)}));  // one 32-bit float
}

TEST(Constraints, RefuseTwoVerticesAtOnePlace) {
  const Asset asset = asset_of({shapes::grid(2, 2)});
  expect_refused(asset, {pin(8, 0.1, 0.2), pin(0, 0, 0), pin(4, 0.1, 0.2)}, "/constraints/2",
                 "constraint 0 places another vertex");
  expect_refused(asset, {pin(8, 0.1, 0.2), pin(0, 0, 0), pin(4, 0.1, 0.2 + 1e-12)},
                 "/constraints/2", "constraint 0 places another vertex");
  EXPECT_NO_THROW(constrained(asset, {pin(8, 0.1, 0.2), pin(0, 0, 0), soft(4, 0.1, 0.2, 1)}));
}

TEST(Constraints, RefuseTargetsThatTellNoSize) {
  const Asset asset = asset_of({shapes::grid(2, 2)});
  expect_refused(asset, {soft(8, 0.1, 0.2, 1), soft(0, 0.1, 0.2, 1)}, "/constraints/1", "size");
  expect_refused(asset, {pin(8, 0.1, 0.2), soft(0, 0.1, 0.2, 1)}, "/constraints/1", "size");
  EXPECT_NO_THROW(constrained(asset, {soft(8, 0.1, 0.2, 1)}));
}

TEST(Constraints, StopWhenAsked) {
  const Asset asset = asset_of({shapes::grid(2, 2)});
  std::stop_source source;
  source.request_stop();
  const std::vector<PositionConstraint> constraints{pin(0, 0, 0)};
  EXPECT_THROW(page_constraints(asset.surfaces, asset.charts, constraints, source.get_token()),
               Error);
}

TEST(Constraints, RefuseChartsThatHaveNone) {
  const Asset asset = asset_of({shapes::grid(2, 2), shapes::grid(3, 3)});
  expect_refused(asset, {pin(0, 0, 0)}, "/constraints", "face 0 of mesh 1");
  PositionConstraint second = pin(0, 1, 1);
  second.surface = 1;
  EXPECT_NO_THROW(constrained(asset, {pin(0, 0, 0), second}));
}

}  // namespace
}  // namespace unwrapd::charts
