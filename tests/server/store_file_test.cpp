// A data directory that has lost what it knows of its files.
#include <gmock/gmock.h>

#include "running_server.hpp"
#include "server/store_file.hpp"
#include "tests/api/error_of.hpp"

namespace unwrapd::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class StoreFile : public RunningServer {
 protected:
  [[nodiscard]] std::filesystem::path store() const { return config_.data / kStoreFile; }

  /// Whether nothing is served, what is to be done is told, and the files of the job are left.
  void expect_refused(const std::string& job) {
    const Error error = error_of([this] { start(); });
    EXPECT_EQ(error.code(), ErrorCode::storage_failed);
    EXPECT_THAT(error.what(), AllOf(HasSubstr(store().string()), HasSubstr("put it back")));
    EXPECT_TRUE(std::filesystem::exists(config_.data / "blobs" / job / "report.json"));
  }
};

TEST_F(StoreFile, ThatIsLostOrEmptyTakesNoResultsWithIt) {
  start();
  const std::string id = submit();
  await_state(id, "succeeded");
  service_.reset();
  const std::filesystem::path kept = dir_.path() / "kept.sqlite";
  std::filesystem::rename(store(), kept);
  expect_refused(id);
  expect_refused(id);  // what the first try left behind is no store either
  std::filesystem::remove(store());
  write_file(store(), "");
  expect_refused(id);
  for (const char* rest : {"", "-wal", "-shm"}) std::filesystem::remove(store().string() + rest);
  std::filesystem::rename(kept, store());
  start();
  EXPECT_EQ(state(id), "succeeded");
  EXPECT_EQ(get(id, "report")->status, 200);
}

TEST_F(StoreFile, SweepsSayHowMuchTheyRemove) {
  start();
  service_.reset();
  for (const char* job : {"j_a", "j_b"}) make_directories(config_.data / "blobs" / job);
  testing::internal::CaptureStderr();
  const Log log(LogLevel::warning);
  service_ = std::make_unique<Service>(config_, log);
  service_.reset();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr(R"("folders":2)"));
}

}  // namespace
}  // namespace unwrapd::server
