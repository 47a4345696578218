// Pictures and formats are made several at a time, each once: the real server, whose drawing can be
// held up.
#include <gmock/gmock.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "decode_png.hpp"
#include "running_server.hpp"
#include "server/rendering.hpp"

namespace unwrapd::server {
namespace {

using testing::HasSubstr;

constexpr int kHeldUpSize = 100;  // of pictures, pixels

class Makers : public RunningServer {
 protected:
  ~Makers() override { let_go(); }

  void start_held_up() {
    Duties duties;
    duties.draw = [this](const Rendering& what, const RenderingInput& input,
                         const api::Limits& limits) {
      begin(what);
      std::string bytes = render(what, input, limits);
      const std::lock_guard lock(mutex_);
      --at_once_;
      return bytes;
    };
    service_ = std::make_unique<Service>(config_, log_, duties);
  }
  void begin(const Rendering& what) {
    std::unique_lock lock(mutex_);
    ++made_;
    most_at_once_ = std::max(most_at_once_, ++at_once_);
    const bool waits = !what.picture || what.picture->size == kHeldUpSize;
    if (waits) changed_.wait(lock, [&] { return is_let_go_; });
  }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_let_go_ = true;
    changed_.notify_all();
  }
  int made() {
    const std::lock_guard lock(mutex_);
    return made_;
  }
  std::string succeeded(int size = 4) {
    const std::string id = submit("", size);
    await_state(id, "succeeded");
    return id;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_let_go_ = false;
  int made_ = 0, at_once_ = 0, most_at_once_ = 0;
};

TEST_F(Makers, ASmallPictureNeedNotWaitForALargeOne) {
  start_held_up();
  const std::string large = succeeded(), small = succeeded(5);
  std::vector<std::jthread> askers;
  for (const std::string what : {"preview.png?size=100", "layout.png?size=100"})
    askers.emplace_back([&, what] { EXPECT_EQ(get(large, what)->status, 200); });
  await([&] { return made() == 2; });
  EXPECT_EQ(decode_png(get(small, "preview.png?size=64")->body).width, 64);
  let_go();
}

TEST_F(Makers, WhatIsAskedForTwiceAtOnceIsMadeOnce) {
  start_held_up();
  const std::string id = succeeded();
  std::vector<std::jthread> askers;
  std::vector<std::string> bodies(8);
  for (std::string& body : bodies)
    askers.emplace_back([&] { body = get(id, "result", {{"Accept", "application/json"}})->body; });
  await([&] { return made() == 1; });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // so that others come
  let_go();
  askers.clear();
  EXPECT_EQ(made(), 1);
  for (const std::string& body : bodies) EXPECT_EQ(body, bodies.front());
  EXPECT_THAT(bodies.front(), HasSubstr("distortion"));
}

TEST_F(Makers, AreBoundedInNumber) {
  start_held_up();
  std::vector<std::string> ids;
  for (int i = 0; i < 8; ++i) ids.push_back(succeeded(3 + i));
  std::vector<std::jthread> askers;
  for (const std::string& id : ids)
    askers.emplace_back([&] { EXPECT_EQ(get(id, "preview.png?size=100")->status, 200); });
  await([&] { return made() == 4; });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // so that others come
  EXPECT_EQ(made(), 4);
  EXPECT_EQ(get(ids.front(), "result")->status, 200);  // what is made already needs no place
  let_go();
  askers.clear();
  EXPECT_EQ(made(), 8);
  EXPECT_EQ(most_at_once_, 4);
}

}  // namespace
}  // namespace unwrapd::server
