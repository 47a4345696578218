// Options of megabytes: they cost no memory while they come, and no row, event or list repeats
// them.
#include "server/store/stored_input.hpp"

#include <gmock/gmock.h>

#include "api/options.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::store {
namespace {

using testing::HasSubstr;

constexpr int kHeld = 72;  // vertices of the sheet's first row: their text is a file of its own
constexpr int kVertices = (kHeld + 1) * (kHeld + 1);

/// So many vertices are held on a line, and a last one that may not be there.
std::string long_options(int vertices, int last) {
  api::Json held = api::Json::array();
  for (int v = 0; v < vertices; ++v)
    held.push_back({{"vertex", v}, {"uv", {v / 64.0 / 3, 1.0 / 3}}});
  held.push_back({{"vertex", last}, {"uv", {0.5, 0.5}}});
  return api::Json({{"constraints", held}, {"stop", {{"iterations", 3}}}}).dump();
}

class LongOptions : public RunningServer {
 protected:
  httplib::Result send(const std::string& options) {
    return client().Post("/v1/jobs", httplib::MultipartFormDataItems{
                                         {"options", options, "", "application/json"},
                                         {"mesh", grid_obj(kHeld), "grid.obj", "model/obj"}});
  }
  std::string accepted(const std::string& options) {
    const auto answer = send(options);
    EXPECT_EQ(answer->status, 202) << answer->body;
    return api::Json::parse(answer->body).at("id");
  }
};

TEST_F(LongOptions, AreKeptToBeHeldThoughTheyAreNotRepeated) {
  config_.workers = 1;
  config_.drain_seconds = 0;
  start();
  const std::string ahead = submit_endless();
  await_state(ahead, "running");
  const std::string id = accepted(long_options(kHeld, kVertices - 1));
  const std::string wrong = accepted(long_options(kHeld, kVertices));
  EXPECT_FALSE(job(id).at("options").contains("constraints"));
  EXPECT_EQ(job(id).at("options").at("stop").at("iterations"), 3);
  restart();
  client().Delete("/v1/jobs/" + ahead);
  await_state(id, "succeeded");
  await_state(wrong, "failed");
  EXPECT_EQ(job(wrong).at("problem").at("code"), "invalid_constraint");
  EXPECT_EQ(job(wrong).at("problem").at("pointer"), "/constraints/" + std::to_string(kHeld));
  const std::string seen = client().Get("/v1/jobs/" + id + "/events")->body;
  EXPECT_THAT(seen, HasSubstr("event: succeeded"));
  EXPECT_THAT(seen, testing::Not(HasSubstr("vertex\":")));
}

TEST_F(LongOptions, ThatAreDamagedFailTheJobRatherThanHoldNothing) {
  config_.workers = 1;
  start();
  const std::string ahead = submit_endless();
  await_state(ahead, "running");
  const std::string id = accepted(long_options(kHeld, kVertices - 1));
  std::filesystem::remove(dir_.path() / "blobs" / id / blobs::kOptionsFile);
  client().Delete("/v1/jobs/" + ahead);
  await_state(id, "failed");
  EXPECT_THAT(job(id).at("problem").at("code"),
              testing::AnyOf("storage_corrupt", "storage_failed"));
}

TEST_F(LongOptions, TellQuestionsApart) {
  start();
  const std::string id = accepted(long_options(kHeld, kVertices - 1));
  await_state(id, "succeeded");
  EXPECT_EQ(job(accepted(long_options(kHeld, kVertices - 1))).at("attempt"), 0)
      << "answered from the store";
  const std::string other = accepted(long_options(kHeld, kVertices - 2));
  await_state(other, "succeeded");
  EXPECT_EQ(job(other).at("attempt"), 1);
}

TEST_F(LongOptions, AreBoundedAndLeaveNothing) {
  start();
  const std::string spaces(api::kMaxOptionsBytes, ' ');
  expect_problem(send("{}" + spaces), 413, "body_too_large");
  const auto most = send(spaces.substr(2) + "{}");
  EXPECT_EQ(most->status, 202) << most->body;
  await_state(api::Json::parse(most->body).at("id"), "succeeded");
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(dir_.path() / "blobs"))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr(".sent")));
}

}  // namespace
}  // namespace unwrapd::server::store
