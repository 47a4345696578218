// A data directory that has lost what it knows of its files.
#include <gmock/gmock.h>

#include "server/store/data_directory.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::store {
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
    EXPECT_THAT(error.what(), AllOf(HasSubstr(store().string()), HasSubstr("restore it")));
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

TEST_F(StoreFile, ThatHasItsRowsInADamagedWalKeepsThatFile) {
  start();
  const std::string id = submit();
  await_state(id, "succeeded");
  const std::filesystem::path killed = dir_.path() / "killed";  // as kill -9 would leave it
  std::filesystem::create_directories(killed);
  for (const char* name : {"jobs.sqlite", "jobs.sqlite-wal", "blobs", "digests-noted"})
    std::filesystem::copy(config_.data / name, killed / name,
                          std::filesystem::copy_options::recursive);
  service_.reset();
  config_.data = killed;
  const std::filesystem::path wal = killed / "jobs.sqlite-wal";
  std::string bytes = read_file(wal);
  bytes.replace(0, 32, 32, 'x');
  write_file(wal, bytes);
  expect_refused(id);
  ASSERT_TRUE(std::filesystem::exists(wal));
  EXPECT_EQ(read_file(wal), bytes);
}

TEST_F(StoreFile, SweepsSayHowMuchTheySetAside) {
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
}  // namespace unwrapd::server::store
