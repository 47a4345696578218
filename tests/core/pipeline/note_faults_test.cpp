// No fault of a result passes in silence.
#include "core/pipeline/note_faults.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/core/shapes.hpp"
#include "tests/core/unwrapped_surface.hpp"

namespace unwrapd {
namespace {

std::vector<const Note*> notes_of(const Unwrapped& unwrapped, NoteCode code) {
  std::vector<const Note*> found;
  for (const Note& note : unwrapped.report.notes)
    if (note.code == code) found.push_back(&note);
  return found;
}

/// An open cylinder: a disk with a hole, whose only map as one chart is a ring.
Surface cylinder() {
  return shapes::surface_of(
      shapes::mapped_grid(32, 20, shapes::Wrap::first, [](double u, double v) {
        return Vec3(std::cos(shapes::kTurn * u), std::sin(shapes::kTurn * u), 10 * v);
      }));
}

TEST(NoteFaults, TellTheWorstChartAndItsPlace) {
  const Unwrapped ring = unwrapped_surface(cylinder(), {});
  const auto notes = notes_of(ring, NoteCode::distorted);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("chart 0"), std::string::npos);
  EXPECT_NE(notes[0]->text.find("max_distortion=2.02"), std::string::npos);
}

TEST(NoteFaults, AdviseWhatTheOtherOptionsAllow) {
  const auto advice = [](const UnwrapOptions& options) {
    const Unwrapped ring = unwrapped_surface(cylinder(), options);
    const auto notes = notes_of(ring, NoteCode::distorted);
    return notes.empty() ? std::string() : notes.front()->text;
  };
  const std::string of_boundary = advice({.boundary = BoundaryShape::square});
  EXPECT_NE(of_boundary.find("Leave out boundary, which keeps"), std::string::npos) << of_boundary;
  const std::string of_count = advice({.max_charts = 1});
  EXPECT_NE(of_count.find("Send max_distortion=2.02 and max_charts=none"), std::string::npos)
      << of_count;
}

TEST(NoteFaults, TellAPaddingThatIsReduced) {
  std::vector<TriMesh> plates;
  for (int k = 0; k < 5; ++k)
    plates.push_back(shapes::moved(shapes::grid(4, 4), Vec3(10 * k, 0, 0)));
  UnwrapOptions options;
  options.padding = options.resolution / 4;
  const Unwrapped few = unwrapped_surface(shapes::surface_of(shapes::merged(plates)), options);
  const auto notes = notes_of(few, NoteCode::padding_reduced);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("A padding of 256 texels"), std::string::npos) << notes[0]->text;
  EXPECT_EQ(notes[0]->text.find(".000"), std::string::npos) << notes[0]->text;
}

/// A square beside one of this side.
TEST(NoteFaults, TellIslandsSmallerThanATexel) {
  for (const double side : {0.1, 0.0005}) {
    TriMesh small = shapes::grid(1, 1);
    for (Vec3& p : small.positions) p = side * p + Vec3(5, 0, 0);
    const std::array both{shapes::grid(4, 4), small};
    const Unwrapped two = unwrapped_surface(shapes::surface_of(shapes::merged(both)), {});
    const auto notes = notes_of(two, NoteCode::islands_tiny);
    ASSERT_EQ(notes.size(), side < 0.001 ? 1U : 0U) << side;
    if (notes.empty()) continue;
    EXPECT_EQ(notes[0]->text.find("1 of 2 islands"), 0U) << notes[0]->text;
  }
}

TEST(NoteFaults, TellSeamsAtUvsThatThereAreNot) {
  Surface surface = shapes::surface_of(shapes::grid(2, 2));
  const auto told = [&](SeamMode seams) {
    return notes_of(unwrapped_surface(surface, {.seams = seams}), NoteCode::option_unused).size();
  };
  EXPECT_EQ(told(SeamMode::uv0), 1U);
  EXPECT_EQ(told(SeamMode::automatic), 0U);
  surface.corner_uv.assign(surface.mesh.faces.size(), {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)});
  EXPECT_EQ(told(SeamMode::uv0), 0U);
}

/// A plate, and a tube beside it.
TEST(NoteFaults, NameTheWorstOfSeveralCharts) {
  const std::array meshes{shapes::grid(8, 8), shapes::moved(cylinder().mesh, Vec3(40, 0, 0)),
                          shapes::grid(4, 4)};
  const Unwrapped all = unwrapped_surface(shapes::surface_of(shapes::merged(meshes)), {});
  ASSERT_EQ(all.report.charts.size(), 3U);
  const auto notes = notes_of(all, NoteCode::distorted);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("1 of 3 charts"), std::string::npos) << notes[0]->text;
  EXPECT_NE(notes[0]->text.find("chart 1, on"), std::string::npos) << notes[0]->text;
  EXPECT_NE(notes[0]->text.find("near (40, "), std::string::npos) << notes[0]->text;
}

/// No chart is distorted badly, but the bound is a tight one.
TEST(NoteFaults, TellABoundThatTheMeanMisses) {
  const Surface cap = shapes::surface_of(shapes::sphere_cap(24, 8, 1));
  const Unwrapped one = unwrapped_surface(cap, {.max_distortion = 2.001, .max_charts = 1});
  ASSERT_GT(one.report.distortion.angle, 2.002);
  ASSERT_LT(one.report.distortion.area, 2.1);
  const auto notes = notes_of(one, NoteCode::distorted);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("max_charts leaves no room"), std::string::npos) << notes[0]->text;
}

TEST(NoteFaults, AreSilentWhereThereIsNone) {
  const Unwrapped slit =
      unwrapped_surface(cylinder(), {.max_distortion = 2.02, .guarantee = Guarantee::bijective});
  EXPECT_LT(slit.report.distortion.angle, 2.02);
  EXPECT_EQ(slit.report.overlaps, 0);
  EXPECT_TRUE(notes_of(slit, NoteCode::distorted).empty());
  EXPECT_TRUE(notes_of(slit, NoteCode::overlaps).empty());
}

TEST(NoteFaults, TellOverlapsAndHowToPreventThem) {
  const Surface ramp = shapes::surface_of(  // more than a turn, which lies flat on itself
      shapes::mapped_grid(96, 4, shapes::Wrap::none, [](double u, double v) {
        const double angle = shapes::kTurn * 1.6 * u, radius = 1 + 0.5 * (1 - v);
        return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.6 * u);
      }));
  const Unwrapped free = unwrapped_surface(ramp, {});
  ASSERT_GT(free.report.overlaps.value_or(0), 0);
  const auto notes = notes_of(free, NoteCode::overlaps);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("guarantee=bijective"), std::string::npos);
  EXPECT_TRUE(
      notes_of(unwrapped_surface(ramp, {.guarantee = Guarantee::bijective}), NoteCode::overlaps)
          .empty());
}

}  // namespace
}  // namespace unwrapd
