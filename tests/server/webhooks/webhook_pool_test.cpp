// Who may be called while others hang: real threads, and calls that hang until they are told.
#include "server/webhooks/webhook_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>

#include "server/webhooks/webhook_url.hpp"

namespace unwrapd::server::webhooks {
namespace {

constexpr int kAtOnce = 16;
constexpr int kPerReceiver = 2;

class WebhookPlaces : public testing::Test {
 protected:
  ~WebhookPlaces() override { go_.count_down(); }

  static WebhookReceiver of(const std::string& host, const std::string& owner = "ours") {
    return {.owner = owner, .host = host};
  }
  bool has_room(const std::string& host) { return pool_.has_room(of(host)); }
  void hang(const std::string& host, const std::string& owner = "ours") {
    pool_.begin(of(host, owner), [this](const std::stop_token&) {
      go_.wait();
      return false;
    });
  }
  /// A call that has ended by now.
  void call(const std::string& host, bool answered) {
    const int before = ended_;
    pool_.begin(of(host), [=](const std::stop_token&) { return answered; });
    while (ended_ == before) std::this_thread::yield();
  }

  std::latch go_{1};
  std::atomic<int> ended_ = 0;
  WebhookPool pool_{kAtOnce, kPerReceiver, [this] { ++ended_; }};
};

TEST_F(WebhookPlaces, FourHostsThatHangLeaveRoomForANewOne) {
  for (const char* host : {"a", "b", "c", "d"}) {
    EXPECT_TRUE(has_room(host));
    hang(host);
    EXPECT_FALSE(has_room(host));
  }
  EXPECT_TRUE(has_room("new"));
}

TEST_F(WebhookPlaces, HostsThatHangHaveHalfOfThePlacesHoweverManyTheyAre) {
  call("proven", true);
  for (int i = 0; i < kAtOnce / 2; ++i) hang(std::to_string(i), std::to_string(i % 2));
  EXPECT_FALSE(has_room("new"));
  EXPECT_TRUE(has_room("proven"));
  hang("proven");
  EXPECT_TRUE(has_room("proven"));
  hang("proven");
  EXPECT_FALSE(has_room("proven"));
  EXPECT_FALSE(pool_.is_full());
}

TEST_F(WebhookPlaces, AHostThatHangsForOneOwnerIsNewToAnother) {
  hang("host");
  EXPECT_FALSE(has_room("host"));
  EXPECT_TRUE(pool_.has_room(of("host", "theirs")));
}

TEST_F(WebhookPlaces, ReceiversOfOneOwnerLeavePlacesToAnother) {
  int hanging = 0;
  for (; has_room(std::to_string(hanging)); ++hanging) hang(std::to_string(hanging));
  EXPECT_GE(hanging, kAtOnce / 4);
  EXPECT_EQ(pool_.of_owner("ours"), hanging);
  EXPECT_TRUE(pool_.has_room(of("new", "theirs")));
}

TEST_F(WebhookPlaces, ProvenReceiversOfOneOwnerLeavePlacesToAnother) {
  for (int i = 0; i < kAtOnce; ++i) call(std::to_string(i), true);
  int hanging = 0;
  for (; has_room(std::to_string(hanging)); ++hanging) hang(std::to_string(hanging));
  EXPECT_GT(hanging, kAtOnce / 2);
  EXPECT_LT(hanging, kAtOnce);
  EXPECT_TRUE(pool_.has_room(of("new", "theirs")));
}

/// Calls to receivers that were proven when they began are no trials, even if they hang.
TEST_F(WebhookPlaces, ReceiversThatWereProvenLeaveTrialsToAnotherOwner) {
  for (int i = 0; i < kAtOnce / 2; ++i) {
    const std::string host = std::to_string(i);
    call(host, true);
    hang(host);
    call(host, false);
    EXPECT_FALSE(has_room(host));
  }
  EXPECT_TRUE(pool_.has_room(of("new", "theirs")));
}

TEST_F(WebhookPlaces, AHostIsWhatTheAddressNamesHoweverItIsWritten) {
  for (const auto& [url, host] : {std::pair{"http://[fd00:1::1]:81/x", "fd00:1::1"},
                                  {"http://[fd00:2::2]/", "fd00:2::2"},
                                  {"https://Example.com:8443?a:b", "example.com"},
                                  {"http://a.b/http://c", "a.b"}})
    EXPECT_EQ(webhook_host(url), host);
  EXPECT_EQ(webhook_host("no address"), "no address");
}

TEST_F(WebhookPlaces, AHostThatFailsHasToProveItselfAgain) {
  call("host", true);
  call("host", false);
  hang("host");
  EXPECT_FALSE(has_room("host"));
}

}  // namespace
}  // namespace unwrapd::server::webhooks
