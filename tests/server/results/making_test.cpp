// Pictures and formats are made several at a time, each once: the real server, whose drawing can be
// held up.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/error.hpp"
#include "server/work/rendering.hpp"
#include "tests/server/decode_png.hpp"
#include "tests/server/raw_client.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::results {
namespace {

using testing::HasSubstr;

constexpr int kHeldUpSize = 100;   // of pictures, pixels
constexpr int kCostlySize = 4095;  // the same, and not drawn

class Makers : public RunningServer {
 protected:
  ~Makers() override {
    let_go();
    service_.reset();  // whose threads use the members
  }

  void start_held_up() {
    work::WorkerFunctions functions;
    functions.draw = [this](const work::Rendering& what, const work::RenderingInput& input,
                            const api::Limits& limits) {
      begin(what, input.asset.stop);
      std::string bytes = what.picture && what.picture->size == kCostlySize
                              ? "no picture"
                              : work::render(what, input, limits);
      const std::lock_guard lock(mutex_);
      --at_once_;
      return bytes;
    };
    service_ = std::make_unique<Service>(config_, log_, functions);
  }
  void begin(const work::Rendering& what, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    nice_ = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
    ++made_;
    most_at_once_ = std::max(most_at_once_, ++at_once_);
    const bool waits =
        !what.picture || what.picture->size == kHeldUpSize || what.picture->size == kCostlySize;
    if (!waits || changed_.wait(lock, stop, [&] { return is_let_go_; })) return;
    --at_once_;
    ++stopped_;
    throw Error(ErrorCode::cancelled, "It was stopped.");
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
  int nice() {
    const std::lock_guard lock(mutex_);
    return nice_;
  }
  int stopped() {
    const std::lock_guard lock(mutex_);
    return stopped_;
  }
  std::string succeeded(int size = 4) {
    const std::string id = submit("", size);
    await_state(id, "succeeded");
    return id;
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool is_let_go_ = false;
  int made_ = 0, at_once_ = 0, most_at_once_ = 0, stopped_ = 0, nice_ = 0;
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

TEST_F(Makers, StopWhenWhoAskedHasLeft) {
  start_held_up();
  const std::string id = succeeded();
  std::optional<RawClient> asker(std::in_place, service_->port());
  asker->send("GET /v1/jobs/" + id + "/preview.png?size=100 HTTP/1.1\r\nHost: x\r\n\r\n");
  await([&] { return made() == 1; });
  asker.reset();
  await([&] { return stopped() == 1; });
  let_go();
  EXPECT_EQ(get(id, "preview.png?size=100")->status, 200);
}

TEST_F(Makers, WhoHasLeftDoesNotWaitAnyMore) {
  start_held_up();
  const std::string id = succeeded();
  const std::string path = "/v1/jobs/" + id + "/preview.png?size=100";
  std::jthread first([&] { EXPECT_EQ(client().Get(path)->status, 200); });
  await([&] { return made() == 1; });
  std::optional<RawClient> second(std::in_place, service_->port());
  second->send("GET " + path + " HTTP/1.1\r\nHost: x\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // so that it waits
  second.reset();
  std::this_thread::sleep_for(std::chrono::milliseconds(250));  // so that it is seen to be gone
  let_go();
  first.join();
  EXPECT_EQ(get(id, "layout.png?size=64")->status, 200);  // nobody has a place any more
  EXPECT_EQ(made(), 2);
}

TEST_F(Makers, YieldToAnswers) {
  start_held_up();
  let_go();
  EXPECT_EQ(get(succeeded(), "preview.png?size=64")->status, 200);
  EXPECT_GT(nice(), ::getpriority(PRIO_PROCESS, 0));
}

TEST_F(Makers, DrawOneAtATimeOfThoseThatCostMuchAndAreNotKept) {
  start_held_up();
  std::vector<std::jthread> askers;
  for (int i = 0; i < 3; ++i)
    askers.emplace_back(
        [&, id = succeeded(3 + i)] { EXPECT_EQ(get(id, "preview.png?size=4095")->status, 200); });
  await([&] { return made() == 1; });
  EXPECT_EQ(get(succeeded(7), "preview.png?size=64")->status, 200);
  EXPECT_EQ(made(), 2);
  let_go();
  askers.clear();
  EXPECT_EQ(most_at_once_, 2);
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

TEST_F(Makers, KeepNothingOfAJobForTheNextOneOfItsId) {
  start_held_up();
  const std::string id = "j_" + std::string(32, '7');
  const auto put = [&](int size) {
    client().Put("/v1/jobs/" + id + "?preset=chart", grid_obj(size), "model/obj");
    await_state(id, "succeeded");
  };
  const httplib::Headers json = {{"Accept", "application/json"}};
  put(4);
  std::jthread asker([&] { static_cast<void>(get(id, "result", json)); });
  await([&] { return made() == 1; });
  EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 204);
  put(5);
  let_go();
  asker.join();
  const auto meshes = [&](const std::string& job) {
    return api::Json::parse(get(job, "result", json)->body).at("meshes");
  };
  EXPECT_EQ(meshes(id), meshes(succeeded(5)));
}

}  // namespace
}  // namespace unwrapd::server::results
