// Requests that wait for the ends of jobs leave threads for those that do not.
#include "api/options.hpp"  // Eigen before httplib, whose headers define _res

#include "server/base/concurrency_limit.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/running_server.hpp"

namespace unwrapd::server {
namespace {

TEST(ConcurrencyLimit, AreSoManyAndOfOneKeyHalfAsMany) {
  ConcurrencyLimit waiters(4);
  auto one = waiters.let_in("a");
  const auto two = waiters.let_in("a");
  EXPECT_NE(two, nullptr);
  EXPECT_EQ(waiters.let_in("a"), nullptr);
  one.reset();
  one = waiters.let_in("a");
  EXPECT_NE(one, nullptr) << "who leaves makes room";
  const auto three = waiters.let_in("b"), four = waiters.let_in("");
  EXPECT_NE(three, nullptr);
  EXPECT_NE(four, nullptr);
  EXPECT_EQ(waiters.let_in("c"), nullptr) << "all places are taken";
}

TEST(ConcurrencyLimit, OfFewKeysDoNotTakeAll) {
  ConcurrencyLimit waiters(16);
  std::vector<std::shared_ptr<void>> held;
  const auto take_all = [&](const std::string& owner) {
    int got = 0;
    while (auto place = waiters.let_in(owner)) {
      held.push_back(std::move(place));
      ++got;
    }
    return got;
  };
  EXPECT_EQ(take_all("a"), 8);
  EXPECT_EQ(take_all("b"), 4);
  EXPECT_EQ(take_all("c"), 2);
  EXPECT_EQ(take_all("d"), 1);
  EXPECT_NE(waiters.let_in("e"), nullptr);
}

TEST(ConcurrencyLimit, WithoutKeysAreAllAlike) {
  ConcurrencyLimit waiters(2);
  const auto one = waiters.let_in(""), two = waiters.let_in("");
  EXPECT_NE(two, nullptr);
}

class WaitingRequests : public RunningServer {};

TEST_F(WaitingRequests, LeaveRoomForOthers) {
  config_.edge.max_requests = 2;
  config_.workers = 1;
  start();
  const httplib::Headers wait = {{"Prefer", "wait=60"}};
  const std::string endless = "/v1/jobs?stop.iterations=10000";
  std::thread waiting([&] {
    const auto first = client().Post(endless, wait, grid_obj(120), "model/obj");
    EXPECT_EQ(first->get_header_value("Preference-Applied"), "wait=60");
  });
  await([this] { return api::Json::parse(client().Get("/v1/jobs")->body).at("jobs").size() == 1; });
  const auto second = client().Post("/v1/jobs?method=asap", wait, grid_obj(2), "model/obj");
  EXPECT_EQ(second->status, 202) << "it is not done, and there is no place to wait for it";
  EXPECT_FALSE(second->has_header("Preference-Applied"));
  const auto third = client().Post("/v1/unwrap", grid_obj(2), "model/obj");
  expect_problem(third, 429, "rate_limited");
  EXPECT_GE(std::stoi(third->get_header_value("Retry-After")), 1);
  const api::Json jobs = api::Json::parse(client().Get("/v1/jobs")->body).at("jobs");
  ASSERT_EQ(jobs.size(), 2U);
  for (const api::Json& job : jobs) client().Delete("/v1/jobs/" + job.at("id").get<std::string>());
  waiting.join();
}

/// All who may wait for jobs do, and all who may wait for pictures, beside those who make some.
TEST_F(WaitingRequests, ForJobsAndPicturesTogetherLeaveThreadsForOthers) {
  config_.edge.max_requests = 1;
  config_.workers = 1;
  std::promise<void> release;
  std::atomic<int> drawing = 0;
  work::WorkerFunctions functions;
  functions.draw = [&, released = release.get_future().share()](const auto&...) {
    ++drawing;
    released.wait();
    return std::string("x");
  };
  service_ = std::make_unique<Service>(config_, log_, functions);
  const std::string small = submit("?method=asap", 2);
  await_state(small, "succeeded");
  std::vector<std::jthread> others;
  for (int k = 0; k < 8; ++k)  // two draw, half of the places, and one waits; the rest are refused
    others.emplace_back([&, k] {
      client().Get("/v1/jobs/" + small + "/preview.png?size=" + std::to_string(100 + k));
    });
  others.emplace_back([&] {
    client().Post("/v1/jobs?stop.iterations=10000", {{"Prefer", "wait=60"}}, grid_obj(120),
                  "model/obj");
  });
  await([&] { return drawing == 2; });
  const std::string live = "/v1/jobs?state=running";
  std::string running;
  await([&] {
    const api::Json jobs = api::Json::parse(client().Get(live)->body).at("jobs");
    if (!jobs.empty()) running = jobs.at(0).at("id").get<std::string>();
    return !running.empty();
  });
  EXPECT_EQ(client().Get("/healthz")->status, 200);
  client().Delete("/v1/jobs/" + running);
  release.set_value();
}

}  // namespace
}  // namespace unwrapd::server
