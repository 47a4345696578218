// Frames are read back by a reader of their own, written after the standard's rules.
#include "api/events.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace unwrapd::api {
namespace {

struct Frame {
  std::string id, event, data;
};

/// The frames of a stream, as a browser's EventSource takes them.
std::vector<Frame> read_frames(const std::string& stream) {
  std::vector<Frame> frames;
  Frame frame;
  std::istringstream in(stream);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() && !frame.data.empty()) {
      frames.push_back(std::exchange(frame, {}));
    }
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos || colon == 0) continue;
    const std::string field = line.substr(0, colon);
    const std::string value = line.substr(colon + 2);
    if (field == "id") frame.id = value;
    if (field == "event") frame.event = value;
    if (field == "data") frame.data += (frame.data.empty() ? "" : "\n") + value;
  }
  return frames;
}

TEST(SseFrame, CarriesIdNameAndData) {
  const std::vector<Frame> frames = read_frames(sse_frame({17, "queued", {{"position", 3}}}));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, "17");
  EXPECT_EQ(frames[0].event, "queued");
  EXPECT_EQ(Json::parse(frames[0].data), (Json{{"position", 3}}));
}

TEST(SseFrame, CannotBeBrokenByAnyTextInTheData) {
  const std::vector<std::string> texts = {
      "a\nb", "a\r\nb", "\n\n", "data: x\n\nevent: y", "\r", "line\u2028separator", "id: 9\n"};
  for (const std::string& text : texts) {
    const std::string frame = sse_frame({1, "failed", {{"detail", text}}});
    const std::vector<Frame> frames = read_frames(frame);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frame.find('\r'), std::string::npos);
    EXPECT_EQ(frames[0].id, "1");
    EXPECT_EQ(Json::parse(frames[0].data).at("detail"), text);
  }
}

TEST(SseFrame, HoldsForRandomTextAndEvenForTextThatIsNotUtf8) {
  std::mt19937 rng(9);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int k = 0; k < 2000; ++k) {
    std::string text(static_cast<std::size_t>(k % 50), ' ');
    for (char& c : text) c = static_cast<char>(byte(rng));
    const std::vector<Frame> frames = read_frames(sse_frame({k, "stage", {{"text", text}}}));
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_TRUE(Json::accept(frames[0].data));
  }
}

TEST(SseFrame, PingIsACommentThatReadersPassOver) {
  const std::string stream = std::string(kPing) + sse_frame(queued_event(1, 0)) +
                             std::string(kPing) + sse_frame(started_event(2, 1));
  EXPECT_EQ(read_frames(stream).size(), 2U);
}

TEST(Events, OfACurveSayWhichLambdaTheyAreOf) {
  const Event stage = stage_event(1, {.stage = Stage::solve, .lambda = 0.01});
  const Event iteration = iteration_event(2, {.iteration = 1, .lambda = 1.0}, 0);
  EXPECT_EQ(stage.data.at("lambda"), 0.01);
  EXPECT_EQ(iteration.data.at("lambda"), 1.0);
  EXPECT_FALSE(stage_event(1, {.stage = Stage::solve}).data.contains("lambda"));
  EXPECT_FALSE(iteration_event(2, {.iteration = 1}, 0).data.contains("lambda"));
}

TEST(Events, HaveOnlyFiniteFigures) {
  const double infinity = std::numeric_limits<double>::infinity();
  const IterationEvent iteration{.chart = 1,
                                 .iteration = 2,
                                 .energy = infinity,
                                 .rel_change = -infinity,
                                 .angle = infinity,
                                 .area = std::nan(""),
                                 .flipped = 3,
                                 .fraction = 0.5};
  const Event event = iteration_event(1, iteration, 1.5);
  for (const auto& [name, value] : event.data.items()) {
    EXPECT_TRUE(value.is_number()) << name;
    EXPECT_NE(value.dump(), "null") << name;
  }
}

TEST(Events, ExactlyTheFinalOnesAreLast) {
  EXPECT_FALSE(is_last(queued_event(1, 0)));
  EXPECT_FALSE(is_last(started_event(2, 1)));
  EXPECT_FALSE(is_last(stage_event(3, {})));
  EXPECT_FALSE(is_last(iteration_event(4, {}, 0)));
  EXPECT_FALSE(is_last(gap_event(1, 4)));
  for (const JobState state : {JobState::succeeded, JobState::failed, JobState::cancelled}) {
    const Event event = final_event(5, Job{.id = "j_1", .state = state});
    EXPECT_TRUE(is_last(event));
    EXPECT_EQ(event.name, state_name(state));
    EXPECT_EQ(event.data.at("state"), state_name(state));
  }
}

TEST(Events, AGapLetsAReaderGoOnAfterIt) {
  const Event gap = gap_event(5, 9);
  EXPECT_EQ(gap.seq, 9);
  EXPECT_EQ(gap.data, (Json{{"first", 5}, {"last", 9}}));
}

}  // namespace
}  // namespace unwrapd::api
