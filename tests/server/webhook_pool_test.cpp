// Who may be called while others hang: real threads, and calls that hang until they are told.
#include "server/webhook_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>

#include "server/webhook_url.hpp"

namespace unwrapd::server {
namespace {

constexpr int kAtOnce = 16;
constexpr int kPerHost = 2;

class WebhookPlaces : public testing::Test {
 protected:
  ~WebhookPlaces() override { go_.count_down(); }

  void hang(const std::string& host) {
    pool_.begin(host, [this](const std::stop_token&) {
      go_.wait();
      return false;
    });
  }
  /// A call that has ended by now.
  void call(const std::string& host, bool answered) {
    const int before = ended_;
    pool_.begin(host, [=](const std::stop_token&) { return answered; });
    while (ended_ == before) std::this_thread::yield();
  }

  std::latch go_{1};
  std::atomic<int> ended_ = 0;
  WebhookPool pool_{kAtOnce, kPerHost, [this] { ++ended_; }};
};

TEST_F(WebhookPlaces, FourHostsThatHangLeaveRoomForANewOne) {
  for (const char* host : {"a", "b", "c", "d"}) {
    EXPECT_TRUE(pool_.has_room(host));
    hang(host);
    EXPECT_FALSE(pool_.has_room(host));
  }
  EXPECT_TRUE(pool_.has_room("new"));
}

TEST_F(WebhookPlaces, HostsThatHangHaveHalfOfThePlacesHoweverManyTheyAre) {
  call("proven", true);
  for (int i = 0; i < kAtOnce / 2; ++i) hang(std::to_string(i));
  EXPECT_FALSE(pool_.has_room("new"));
  EXPECT_TRUE(pool_.has_room("proven"));
  hang("proven");
  EXPECT_TRUE(pool_.has_room("proven"));
  hang("proven");
  EXPECT_FALSE(pool_.has_room("proven"));
  EXPECT_FALSE(pool_.is_full());
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
  EXPECT_FALSE(pool_.has_room("host"));
}

}  // namespace
}  // namespace unwrapd::server
