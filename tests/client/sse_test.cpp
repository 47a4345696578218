#include "client/sse.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "api/events.hpp"
#include "expect_failure.hpp"

namespace unwrapd::client {
namespace {

/// The events of a text that arrives in blocks of so many bytes.
std::vector<SseEvent> parse(const std::string& text, std::size_t block) {
  std::vector<SseEvent> events;
  SseParser parser;
  for (std::size_t at = 0; at < text.size(); at += block)
    parser.feed(std::string_view(text).substr(at, block),
                [&](const SseEvent& event) { events.push_back(event); });
  return events;
}

TEST(Sse, ReadsWhatTheServerWritesHoweverItIsCut) {
  const std::string text = api::sse_frame(api::queued_event(1, 3)) + std::string(api::kPing) +
                           api::sse_frame(api::started_event(2, 1));
  for (std::size_t block = 1; block <= text.size(); ++block) {
    const auto events = parse(text, block);
    ASSERT_EQ(events.size(), 2) << block;
    EXPECT_EQ(events[0].id, "1");
    EXPECT_EQ(events[0].name, "queued");
    EXPECT_EQ(events[0].data, R"({"position":3})");
    EXPECT_EQ(events[1].name, "started");
  }
}

TEST(Sse, AnEventThatHasNotEndedIsNotHandedOn) {
  EXPECT_TRUE(parse("id: 1\nevent: started\ndata: {}\n", 7).empty());
}

TEST(Sse, AnEventWithoutEndIsAFailure) {
  SseParser parser;
  const std::string block(1 << 20, 'x');
  const auto feed_all = [&] {
    for (int k = 0; k < 64; ++k) parser.feed(block, [](const SseEvent&) {});
  };
  expect_failure(ExitCode::unreachable, feed_all);
}

TEST(Sse, JoinsDataLinesAndTakesCarriageReturns) {
  const auto events = parse("data: a\r\ndata: b\r\n\r\n", 3);
  ASSERT_EQ(events.size(), 1);
  EXPECT_EQ(events[0].data, "a\nb");
  EXPECT_EQ(events[0].name, "message");
}

TEST(Sse, KeepsTheLastIdAndForgetsNameAndData) {
  const auto events = parse("id: 7\nevent: x\ndata: a\n\ndata\n\n: ping\n\nevent: y\n\n", 100);
  ASSERT_EQ(events.size(), 2);
  EXPECT_EQ(events[1].id, "7");
  EXPECT_EQ(events[1].name, "message");
  EXPECT_EQ(events[1].data, "");
}

}  // namespace
}  // namespace unwrapd::client
