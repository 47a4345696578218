// Requests that wait for the ends of jobs leave threads for those that do not.
#include "api/options.hpp"  // Eigen before httplib, whose headers define _res

#include "server/waiters.hpp"

#include <gmock/gmock.h>

#include <thread>
#include <vector>

#include "running_server.hpp"

namespace unwrapd::server {
namespace {

TEST(Waiters, AreSoManyAndOfOneKeyHalfAsMany) {
  Waiters waiters(4);
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

TEST(Waiters, OfFewKeysDoNotTakeAll) {
  Waiters waiters(16);
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

TEST(Waiters, WithoutKeysAreAllAlike) {
  Waiters waiters(2);
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

}  // namespace
}  // namespace unwrapd::server
