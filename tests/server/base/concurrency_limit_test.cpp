// The limit by itself, and requests that wait for jobs, which leave threads for those that do not.
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

using Place = ConcurrencyLimit::Place;
using Refusal = ConcurrencyLimit::Refusal;

/// Takes places until one is refused.
std::vector<Place> take_all(ConcurrencyLimit& limit, const std::string& owner) {
  std::vector<Place> held;
  while (Place place = limit.try_enter(owner)) held.push_back(std::move(place));
  return held;
}

TEST(ConcurrencyLimit, GivesOneOwnerItsShareAndTellsWhyOneIsRefused) {
  ConcurrencyLimit limit(4, half_of_the_rest);
  Refusal why{};
  Place first = limit.try_enter("a", &why);
  EXPECT_EQ(why, Refusal::none);
  const Place second = limit.try_enter("a");
  EXPECT_EQ(limit.try_enter("a", &why), nullptr);
  EXPECT_EQ(why, Refusal::share);
  EXPECT_EQ(limit.refusal("b"), Refusal::none);
  first.reset();
  first = limit.try_enter("a");
  EXPECT_NE(first, nullptr) << "a place that was given back is free";
  const Place third = limit.try_enter("b"), fourth = limit.try_enter("");
  EXPECT_NE(fourth, nullptr);
  EXPECT_EQ(limit.try_enter("c", &why), nullptr);
  EXPECT_EQ(why, Refusal::full);
  EXPECT_EQ(limit.count(), 4);
  EXPECT_EQ(limit.count("a"), 2);
  EXPECT_EQ(limit.count("c"), 0);
}

TEST(ConcurrencyLimit, APlaceIsHeldUntilItsLastCopyIsGoneAndMayOutliveTheLimit) {
  Place held;
  {
    ConcurrencyLimit limit(1, half_of_all);
    Place place = limit.try_enter("a");
    held = place;
    place.reset();
    EXPECT_EQ(limit.try_enter("b"), nullptr);
    held.reset();
    EXPECT_EQ(limit.count(), 0);
    held = limit.try_enter("b");
  }
  EXPECT_NE(held, nullptr);
}

TEST(ConcurrencyLimit, AFewOwnersDoNotTakeAllPlaces) {
  ConcurrencyLimit limit(16, half_of_the_rest);
  const auto a = take_all(limit, "a"), b = take_all(limit, "b"), c = take_all(limit, "c"),
             d = take_all(limit, "d");
  EXPECT_EQ(a.size(), 8U);
  EXPECT_EQ(b.size(), 4U);
  EXPECT_EQ(c.size(), 2U);
  EXPECT_EQ(d.size(), 1U);
  EXPECT_NE(limit.try_enter("e"), nullptr);
}

TEST(ConcurrencyLimit, SharesAreAsTheirNamesSay) {
  ConcurrencyLimit half(5, half_of_all), one(1, half_of_all), most(16, three_quarters);
  ConcurrencyLimit of_two(8, [](int, int) { return 2; });
  EXPECT_EQ(take_all(half, "a").size(), 2U);
  EXPECT_EQ(take_all(one, "a").size(), 1U);
  EXPECT_EQ(take_all(most, "a").size(), 12U);
  EXPECT_EQ(take_all(of_two, "a").size(), 2U);
}

TEST(ConcurrencyLimit, AnOwnerWithoutANameMayTakeAll) {
  ConcurrencyLimit limit(3, half_of_all);
  EXPECT_EQ(take_all(limit, "").size(), 3U);
}

TEST(ConcurrencyLimit, LetsNoMoreInThanThereArePlacesWhateverThreadsAsk) {
  constexpr int kPlaces = 3;
  ConcurrencyLimit limit(kPlaces, three_quarters);
  std::atomic<int> inside = 0, most = 0, entered = 0;
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < 4; ++k)
      threads.emplace_back([&, owner = std::to_string(k % 2)] {
        for (int i = 0; i < 2000; ++i) {
          const Place place = limit.try_enter(owner);
          if (!place) continue;
          ++entered;
          const int now = ++inside;
          for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) continue;
          --inside;
        }
      });
  }
  EXPECT_LE(most, kPlaces);
  EXPECT_GT(entered, 0);
  EXPECT_EQ(limit.count(), 0);
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
