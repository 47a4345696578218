// The examples of the contract are what the code says: none of them can grow stale.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "api/error_table.hpp"
#include "api/events.hpp"
#include "api/job.hpp"
#include "api/mesh.hpp"
#include "api/openapi.hpp"
#include "api/options.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

std::string example(const std::string& name) {
  const std::ifstream file(std::string(UNWRAPD_EXAMPLES) + "/" + name);
  EXPECT_TRUE(file) << name;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Examples, OfMethodsAndLimitsAreTheDefaults) {
  EXPECT_EQ(example("methods.json"), methods_json(Limits{}).dump(2) + "\n");
  EXPECT_EQ(example("limits.json"), to_json(Limits{}).dump(2) + "\n");
}

TEST(Examples, OfJobsAreReadAndWrittenUnchanged) {
  for (const char* state : {"queued", "running", "succeeded", "failed"}) {
    const std::string text = example("job_" + std::string(state) + ".json");
    const Job job = job_from_json(Json::parse(text));
    EXPECT_EQ(state_name(job.state), state);
    EXPECT_EQ(to_json(job).dump(2) + "\n", text);
    EXPECT_EQ(to_json(parse_options(job.options, Limits{})), job.options);
  }
}

TEST(Examples, OfEveryProblemHaveTheirRowsStatusAndTitle) {
  for (const ErrorRow& row : error_table()) {
    const Json json = Json::parse(example("problem_" + std::string(row.name) + ".json"));
    EXPECT_EQ(problem(error_from_problem(json), json.value("job", "")), json);
    EXPECT_EQ(json.at("code"), row.name);
  }
}

TEST(Examples, OfAnInvalidOptionIsWhatTheParserSays) {
  const Error error = error_of([] { parse_options(Query{{"method", "arab"}}, Limits{}); });
  EXPECT_EQ(Json::parse(example("problem_invalid_option.json")), problem(error));
}

TEST(Examples, OfEventsEndsWithTheExampleJob) {
  const std::string stream = example("events.txt");
  const Job job = job_from_json(Json::parse(example("job_succeeded.json")));
  const std::string last = sse_frame(final_event(6, job));
  EXPECT_TRUE(stream.ends_with(last));
  EXPECT_TRUE(stream.starts_with(sse_frame(queued_event(1, 0)) + sse_frame(started_event(2, 1))));
}

TEST(Examples, OfAStoredMeshIsWhatIsWritten) {
  const std::string text = example("mesh_stored.json");
  const Json json = Json::parse(text);
  const Mesh mesh{.sha256 = json.at("sha256"),
                  .bytes = json.at("bytes"),
                  .media_type = json.at("media_type"),
                  .created = json.at("created"),
                  .expires = json.at("expires")};
  EXPECT_EQ(to_json(mesh).dump(2) + "\n", text);
}

TEST(Contract, IsEmbeddedWhole) {
  const std::string_view text = openapi_yaml();
  EXPECT_TRUE(text.starts_with("openapi: 3.1.0\n"));
  EXPECT_TRUE(text.ends_with("- internal\n"));
}

}  // namespace
}  // namespace unwrapd::api
