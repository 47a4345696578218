// The limit on a job's memory, from the flag to the answer, and the cache from one job to the next.
#include "tests/server/running_server.hpp"

namespace unwrapd::server::jobs {
namespace {

using MemoryLimit = RunningServer;

TEST_F(MemoryLimit, RefusesAJobByItsEstimateAndServesOn) {
  config_.memory.job_bytes = 6'000'000;
  start();
  const auto refused = client().Post("/v1/unwrap", grid_obj(60), "model/obj");  // by its factor
  expect_problem(refused, 413, "too_much_memory");
  EXPECT_NE(refused->body.find(" MB"), std::string::npos) << refused->body;
  const std::string id = submit("", 60);
  await_state(id, "failed");
  EXPECT_EQ(job(id).at("problem").at("code"), "too_much_memory");
  await_state(submit("", 4), "succeeded");
}

TEST_F(MemoryLimit, AnswersTheSameFromTheCache) {
  start();
  const httplib::Headers bypass_cache{
      {"Cache-Control", "no-cache"}};  // not the result that is stored
  const auto ask = [&](const std::string& query) {
    return client().Post("/v1/unwrap" + query, bypass_cache, grid_obj(20), "model/obj");
  };
  const auto first = ask(""), hybrid = ask("?method=hybrid"), again = ask("");
  ASSERT_TRUE(first && again && hybrid);
  EXPECT_EQ(first->status, 200);
  EXPECT_EQ(again->body, first->body);
  EXPECT_NE(hybrid->body, first->body);
}

}  // namespace
}  // namespace unwrapd::server::jobs
