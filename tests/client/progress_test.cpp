#include "client/progress.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "api/events.hpp"

namespace unwrapd::client {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

ProgressState after(ProgressState state, const api::Event& event) {
  return advance(std::move(state), event.name, event.data);
}

/// In the middle of a job: chart 2 of 3, iteration 7.
ProgressState busy() {
  const ProgressState solving = after(
      {},
      api::stage_event(3, {.stage = Stage::solve, .chart = 1, .chart_count = 3, .fraction = 0.4}));
  return after(solving, api::iteration_event(4,
                                             {.chart = 1,
                                              .iteration = 7,
                                              .energy = 0.0469,
                                              .rel_change = 1e-3,
                                              .angle = 2.0615,
                                              .area = 2.0566,
                                              .flipped = 2,
                                              .fraction = 0.52},
                                             12));
}

TEST(Progress, TellsWhatTheEventsTold) {
  const std::string line = progress_line(busy(), 200);
  for (const char* part : {"solve chart 2/3", " 52%", "iteration 7", "E 0.0469", "D_angle 2.06",
                           "D_area 2.057", "flips 2"})
    EXPECT_THAT(line, HasSubstr(part));
}

TEST(Progress, OfSeveralLambdasSaysWhichOneAsLongAsTheEventsDo) {
  const StageEvent of_one = {.stage = Stage::solve, .fraction = 0.3, .lambda = 0.01};
  const ProgressState one = after({}, api::stage_event(1, of_one));
  EXPECT_THAT(progress_line(one, 200), HasSubstr("solve lambda 0.01 "));
  const ProgressState all = after(one, api::stage_event(2, {.stage = Stage::pack}));
  EXPECT_THAT(progress_line(all, 200), testing::Not(HasSubstr("lambda")));
}

TEST(Progress, NeverGrowsWiderThanTheTerminal) {
  for (std::size_t width = 1; width <= 160; ++width)
    EXPECT_LE(progress_line(busy(), width).size(), width);
}

TEST(Progress, TheBarGivesWayBeforeTheFigures) {
  const std::string narrow = progress_line(busy(), 79);
  EXPECT_THAT(narrow, HasSubstr("flips 2"));
  EXPECT_THAT(progress_line(busy(), 200), HasSubstr("[============>           ]"));
}

TEST(Progress, TheBarIsFullAtTheEnd) {
  ProgressState state;
  state.fraction = 1;
  EXPECT_THAT(progress_line(state, 100), HasSubstr("[========================] 100%"));
}

TEST(Progress, ANewStageForgetsTheIteration) {
  const ProgressState packing = after(
      busy(),
      api::stage_event(9, {.stage = Stage::pack, .chart = 0, .chart_count = 3, .fraction = 0.9}));
  EXPECT_EQ(packing.stage, "pack");
  EXPECT_EQ(packing.iteration, 0);
}

TEST(Progress, PassesOverWhatItDoesNotKnow) {
  const ProgressState before = busy();
  for (const char* text : {"null", "[]", R"({"chart":"two","fraction":{},"energy":null})", "{}"}) {
    const ProgressState now = advance(before, "iteration", api::Json::parse(text));
    EXPECT_EQ(progress_line(now, 200), progress_line(before, 200)) << text;
  }
  EXPECT_EQ(progress_line(advance(before, "new_event", api::Json::object()), 200),
            progress_line(before, 200));
  const ProgressState stage = advance(before, "stage", api::Json::parse(R"({"name":7})"));
  EXPECT_EQ(stage.stage, "solve");
}

/// What is drawn when the state changes every millisecond for so long.
std::string drawn(ProgressStyle style, milliseconds duration) {
  std::ostringstream out;
  {
    ProgressView view(out, style, 79);
    for (milliseconds now{0}; now < duration; ++now)
      view.show(busy(), ProgressView::Clock::time_point(now));
  }
  return out.str();
}

TEST(ProgressView, RedrawsABarAtMostTwentyTimesASecond) {
  const std::string text = drawn(ProgressStyle::bar, milliseconds(1000));
  EXPECT_EQ(std::ranges::count(text, '\r'), 20 + 1);  // and takes it away at the end
  EXPECT_EQ(std::ranges::count(text, '\n'), 0);
}

TEST(ProgressView, WritesPlainLinesOnceASecond) {
  const std::string text = drawn(ProgressStyle::lines, milliseconds(3000));
  EXPECT_EQ(std::ranges::count(text, '\n'), 3);
  EXPECT_EQ(text.find_first_of("\r\x1b"), std::string::npos);
}

TEST(ProgressView, WritesALineForEveryStage) {
  std::ostringstream out;
  ProgressView view(out, ProgressStyle::lines, 79);
  ProgressState state;
  for (const char* stage : {"queued", "read", "solve"}) {
    state.stage = stage;
    view.show(state, ProgressView::Clock::time_point());
  }
  EXPECT_EQ(out.str(), "queued   0%\nread   0%\nsolve   0%\n");
}

TEST(ProgressView, TellsTheLastFiguresOfTheSolveHoweverFastItWas) {
  std::ostringstream out;
  ProgressView view(out, ProgressStyle::lines, 79);
  const ProgressView::Clock::time_point now;
  const ProgressState begun =
      after({}, api::stage_event(1, {.stage = Stage::solve, .chart_count = 1}));
  ProgressState state = begun;
  for (int i = 1; i <= 10; ++i) {
    view.show(state, now);
    state = after(begun, api::iteration_event(1 + i, {.iteration = i}, 0));
  }
  view.show(state, now);
  view.show(after(state, api::stage_event(12, {.stage = Stage::pack, .chart_count = 1})), now);
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 3);
  EXPECT_THAT(out.str(), HasSubstr("iteration 10 "));
}

TEST(ProgressView, DoesNotRepeatAStageForEveryChart) {
  std::ostringstream out;
  ProgressView view(out, ProgressStyle::lines, 79);
  ProgressState state;
  for (state.chart = 0; state.chart < 400; ++state.chart) {
    for (const char* stage : {"factor", "solve"}) {
      state.stage = stage;
      view.show(state, ProgressView::Clock::time_point());
    }
  }
  EXPECT_EQ(std::ranges::count(out.str(), '\n'), 2);
}

TEST(ProgressView, IsSilentWhenAskedTo) {
  EXPECT_EQ(drawn(ProgressStyle::none, milliseconds(3000)), "");
}

}  // namespace
}  // namespace unwrapd::client
