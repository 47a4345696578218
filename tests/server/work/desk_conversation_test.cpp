// What a worker process may ask of the desk where bundles are exchanged: a mesh may have taken it
// over.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/base/byte_pack.hpp"
#include "core/base/error.hpp"
#include "server/work/socket_work.hpp"

namespace unwrapd::server::work {
namespace {

const std::string kStage(64, 'a');

/// Hands out bundles in order, and keeps what is published.
class SmallDesk final : public WorkDesk {
 public:
  std::optional<Claim> claim(std::string_view /*stage*/, int bundles) override {
    if (next == bundles) return std::nullopt;
    return Claim{next++, before};
  }
  void publish(std::string_view /*stage*/, int bundle, std::string_view bytes) override {
    published[bundle] = bytes;
  }
  std::optional<std::string> obtain(std::string_view /*stage*/, int bundle,
                                    std::chrono::milliseconds patience) override {
    asked_ms = patience.count();
    const auto found = published.find(bundle);
    return found == published.end() ? std::nullopt : std::optional(found->second);
  }

  int next = 0;
  std::optional<std::string> before;  // what was made of each bundle
  std::map<int, std::string> published;
  std::int64_t asked_ms = 0;
};

Frame claim(std::int32_t bundles, const std::string& stage = kStage) {
  return {FrameKind::claim, stage, BytePacker().add(bundles).take()};
}
Frame publish(std::int32_t bundle, const std::string& bytes, const std::string& stage = kStage) {
  return {FrameKind::publish, stage, BytePacker().add(bundle).take() + bytes};
}
Frame obtain(std::int32_t bundle, std::int64_t patience_ms) {
  return {FrameKind::obtain, kStage, BytePacker().add(bundle).add(patience_ms).take()};
}

void expect_refused(DeskConversation& desk, const Frame& frame) {
  try {
    desk.answer(frame);
    ADD_FAILURE() << "answered";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
  }
}

TEST(DeskConversation, HandsOverWhatWasClaimedAndPublished) {
  SmallDesk desk;
  DeskConversation conversation(&desk);
  const std::string first = conversation.answer(claim(2)).value();
  EXPECT_EQ(ByteUnpacker(first).next<std::int32_t>(), 0);
  EXPECT_FALSE(conversation.answer(publish(0, "made")));
  EXPECT_EQ(desk.published[0], "made");
  const std::string found = conversation.answer(obtain(0, 5)).value();
  EXPECT_EQ(found.substr(found.size() - 4), "made");
  EXPECT_EQ(desk.asked_ms, 5);
  conversation.answer(claim(2));
  const std::string none = conversation.answer(claim(2)).value();
  EXPECT_EQ(ByteUnpacker(none).next<std::int32_t>(), -1);
}

TEST(DeskConversation, TakesABundleThatWasMadeBeforeButNotSoundly) {
  SmallDesk desk;
  desk.before = "unsound";
  DeskConversation conversation(&desk);
  const std::string claimed = conversation.answer(claim(2)).value();
  EXPECT_EQ(claimed.substr(claimed.size() - 7), "unsound");
  EXPECT_FALSE(conversation.answer(publish(0, "made")));
  EXPECT_EQ(desk.published[0], "made");
}

TEST(DeskConversation, RefusesWhatNoSoundProcessAsks) {
  SmallDesk desk;
  DeskConversation conversation(&desk);
  expect_refused(conversation, claim(0));
  expect_refused(conversation, claim(1 << 20));
  expect_refused(conversation, claim(2, "../jobs"));
  expect_refused(conversation, {FrameKind::claim, kStage, "x"});
  expect_refused(conversation, publish(0, "not claimed"));
  conversation.answer(claim(2));
  expect_refused(conversation, publish(1, "of another"));
  expect_refused(conversation, publish(0, "of another stage", std::string(64, 'b')));
  expect_refused(conversation, publish(-1, ""));
  conversation.answer(publish(0, "made"));
  expect_refused(conversation, publish(0, "again"));
  expect_refused(conversation, obtain(-1, 0));
  expect_refused(conversation, obtain(1 << 20, 0));
  EXPECT_EQ(desk.published.size(), 1U);
  conversation.answer(obtain(0, -1));
  EXPECT_EQ(desk.asked_ms, 0);
  conversation.answer(obtain(0, std::int64_t{1} << 60));
  EXPECT_LE(desk.asked_ms, 600'000);
  DeskConversation alone(nullptr);
  expect_refused(alone, claim(2));
}

TEST(DeskConversation, KnowsFewStages) {
  SmallDesk desk;
  DeskConversation conversation(&desk);
  bool is_refused = false;
  for (int k = 0; k < 1000 && !is_refused; ++k) {
    const std::string stage = std::string(61, 'c') + std::to_string(100 + k % 900);
    desk.next = 0;
    try {
      conversation.answer(claim(2, stage));
    } catch (const Error&) {
      is_refused = true;
    }
  }
  EXPECT_TRUE(is_refused);
}

}  // namespace
}  // namespace unwrapd::server::work
