// No fault of a result passes in silence.
#include "core/pipeline/note_faults.hpp"

#include <gtest/gtest.h>

#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

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

Unwrapped unwrapped(const Surface& surface, const UnwrapOptions& options) {
  SerialExecutor serial;
  return unwrap(std::vector{surface}, options, {}, serial);
}

TEST(NoteFaults, TellTheWorstChartAndItsPlace) {
  const Unwrapped ring = unwrapped(cylinder(), {});
  const auto notes = notes_of(ring, NoteCode::distorted);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("chart 0"), std::string::npos);
  EXPECT_NE(notes[0]->text.find("max_distortion=2.02"), std::string::npos);
}

TEST(NoteFaults, AreSilentWhereThereIsNone) {
  const Unwrapped slit =
      unwrapped(cylinder(), {.max_distortion = 2.02, .guarantee = Guarantee::bijective});
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
  const Unwrapped free = unwrapped(ramp, {});
  ASSERT_GT(free.report.overlaps.value_or(0), 0);
  const auto notes = notes_of(free, NoteCode::overlaps);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0]->text.find("guarantee=bijective"), std::string::npos);
  EXPECT_TRUE(
      notes_of(unwrapped(ramp, {.guarantee = Guarantee::bijective}), NoteCode::overlaps).empty());
}

}  // namespace
}  // namespace unwrapd
