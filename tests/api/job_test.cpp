#include "api/job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "api/error_table.hpp"
#include "api/options.hpp"
#include "contract_text.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

const std::string kId = "j_0123456789abcdef0123456789abcdef";

Job random_job(std::mt19937& rng) {
  std::uniform_int_distribution<int> small(0, 1000);
  std::uniform_real_distribution<double> figure(0, 1e6);
  Job job;
  job.id = kId;
  job.state = static_cast<JobState>(small(rng) % 5);
  job.created = "2026-01-31T23:59:58.123Z";
  if (is_final(job.state)) job.finished = "2026-02-01T00:00:01.456Z", job.duration = 3.333;
  job.attempt = small(rng);
  job.options = to_json(JobOptions{});
  if (small(rng) % 2 == 0) {
    job.progress = JobProgress{.stage = static_cast<Stage>(small(rng) % 8),
                               .fraction = 1e-6 * figure(rng),
                               .chart = small(rng),
                               .iteration = small(rng),
                               .energy = figure(rng)};
  }
  if (job.state == JobState::failed) {
    job.problem = problem(Error(ErrorCode::zero_area, "It has no area."), kId);
  }
  return job;
}

TEST(Job, SurvivesJsonWhateverItHolds) {
  std::mt19937 rng(3);
  for (int k = 0; k < 1000; ++k) {
    const Json json = to_json(random_job(rng));
    EXPECT_EQ(to_json(job_from_json(Json::parse(json.dump()))), json);
  }
}

TEST(Job, LinksLeadBelowItsOwnPath) {
  const Json json = to_json(Job{.id = kId});
  EXPECT_EQ(json.at("links").at("self"), "/v1/jobs/" + kId);
  for (const Json& link : json.at("links")) {
    EXPECT_THAT(link.get<std::string>(), testing::StartsWith(job_path(kId)));
  }
}

TEST(Job, HasProgressAndProblemOnlyWhenThereAreAny) {
  const Json json = to_json(Job{.id = kId});
  EXPECT_FALSE(json.contains("progress"));
  EXPECT_FALSE(json.contains("problem"));
}

TEST(Job, OfAnotherKindIsRefusedWithAnErrorWhateverIsMissing) {
  std::mt19937 rng(5);
  Job job = random_job(rng);
  job.progress = JobProgress{};
  const Json good = to_json(job);
  for (const char* name : {"id", "state", "created", "attempt", "options"}) {
    Json missing = good;
    missing.erase(name);
    EXPECT_EQ(error_of([&] { job_from_json(missing); }).code(), ErrorCode::malformed_request);
    if (std::string_view(name) == "options") continue;
    Json wrong = good;
    wrong[name] = Json::array();
    EXPECT_EQ(error_of([&] { job_from_json(wrong); }).code(), ErrorCode::malformed_request);
  }
  Json unknown = good;
  unknown["state"] = "asleep";
  EXPECT_EQ(error_of([&] { job_from_json(unknown); }).code(), ErrorCode::malformed_request);
  EXPECT_EQ(error_of([] { job_from_json(Json("text")); }).code(), ErrorCode::malformed_request);
}

TEST(Job, WithMembersOfALaterVersionIsRead) {
  std::mt19937 rng(6);
  Json json = to_json(random_job(rng));
  json["colour"] = "green";
  EXPECT_EQ(job_from_json(json).id, kId);
}

TEST(Job, StatesAndStagesAreThoseOfTheContract) {
  std::vector<std::string> states;
  for (int i = 0; i < 5; ++i) states.emplace_back(state_name(static_cast<JobState>(i)));
  EXPECT_EQ(list({"components", "schemas", "JobState"}, "enum"), states);
  for (const std::string& name : states) EXPECT_EQ(state_name(*state_named(name)), name);
  std::vector<std::string> stages;
  for (int i = 0; i <= static_cast<int>(Stage::write); ++i)
    stages.emplace_back(stage_name(static_cast<Stage>(i)));
  EXPECT_EQ(list({"components", "schemas", "Stage"}, "enum"), stages);
  for (const std::string& name : stages) EXPECT_EQ(stage_name(*stage_named(name)), name);
  EXPECT_FALSE(state_named("done"));
  EXPECT_FALSE(stage_named(""));
}

TEST(Job, IsFinalInThreeStates) {
  EXPECT_FALSE(is_final(JobState::queued));
  EXPECT_FALSE(is_final(JobState::running));
  EXPECT_TRUE(is_final(JobState::succeeded));
  EXPECT_TRUE(is_final(JobState::failed));
  EXPECT_TRUE(is_final(JobState::cancelled));
}

}  // namespace
}  // namespace unwrapd::api
