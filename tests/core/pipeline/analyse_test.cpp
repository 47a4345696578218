#include "core/pipeline/analyse.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::pipeline {
namespace {

InputAnalysis analysis_of_shape(const TriMesh& mesh) {
  return analyse(std::vector{shapes::surface_of(mesh)});
}

TEST(Analyse, KnowsShapesWithKnownTopology) {
  const InputReport tube = analysis_of_shape(shapes::annulus(12, 3)).input;
  EXPECT_EQ(tube.components, 1);
  EXPECT_EQ(tube.boundaries, 2);
  EXPECT_EQ(tube.genus, 0);
  const InputReport ring = analysis_of_shape(shapes::torus(12, 8)).input;
  EXPECT_EQ(ring.boundaries, 0);
  EXPECT_EQ(ring.genus, 1);
  EXPECT_EQ(ring.faces, 2 * 12 * 8);
  EXPECT_EQ(ring.vertices, 12 * 8);
}

TEST(Analyse, AddsSurfacesUpAndSaysWhichNeedsARepair) {
  TriMesh twice = shapes::annulus(12, 3);
  twice.faces.push_back(twice.faces.front());
  const std::vector surfaces = {shapes::surface_of(shapes::sphere(1)), shapes::surface_of(twice)};
  const InputAnalysis analysis = analyse(surfaces);
  EXPECT_EQ(analysis.input.components, 2);
  EXPECT_EQ(analysis.input.boundaries, 2);
  ASSERT_EQ(analysis.repairs.size(), 1U);
  EXPECT_EQ(analysis.repairs[0].kind, RepairKind::duplicate_faces_set_aside);
  EXPECT_EQ(analysis.repairs[0].surface, 1);
  EXPECT_EQ(analysis.repairs[0].count, 1);
}

TEST(Analyse, SaysWhatAJobsReportSays) {
  const std::vector surfaces = {shapes::surface_of(shapes::torus(12, 8))};
  SerialExecutor serial;
  const InputReport report = unwrap(surfaces, {}, {}, serial).report.input;
  const InputReport input = analyse(surfaces).input;
  EXPECT_EQ(input.faces, report.faces);
  EXPECT_EQ(input.vertices, report.vertices);
  EXPECT_EQ(input.components, report.components);
  EXPECT_EQ(input.genus, report.genus);
  EXPECT_EQ(input.welded, report.welded);
}

}  // namespace
}  // namespace unwrapd::pipeline
