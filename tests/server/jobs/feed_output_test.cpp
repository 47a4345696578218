#include "server/jobs/feed_output.hpp"

#include <gtest/gtest.h>

#include "server/base/errors.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::jobs {
namespace {

/// Events in the order told, of a ring that forgets none of them.
class FeedOutputs : public testing::Test {
 protected:
  FeedOutputs() {
    job_.record.id = "j_1";
    job_.record.owner = "his";
    std::filesystem::create_directories(blobs_.path("j_1", ""));
    job_.feed = std::make_shared<JobFeed>(0, 100'000);
  }

  [[nodiscard]] std::int64_t told() const { return job_.feed->next_seq() - 1; }

  TempDir dir_;
  blobs::BlobStore blobs_{dir_.path()};
  store::JobStore store_{database_in(dir_.path())};
  store::QuotaReservations reservations_{store_};
  store::QuotaReservation reservation_{reservations_, "his"};
  std::int64_t most_ = 0;
  const std::function<std::int64_t(const std::string&)> most_bytes_ =
      [this](const std::string& owner) { return owner == "his" ? most_ : 0; };
  RunningJob job_;
  FeedOutput output_{job_, blobs_, {reservation_, most_bytes_}};
};

TEST_F(FeedOutputs, TellAStageAsItMovesOnAndNotEachStep) {
  for (int k = 0; k <= 10'000; ++k)
    output_.stage({.stage = Stage::segment, .fraction = .1 + .5 * k / 10'000});
  EXPECT_GE(told(), 90) << "half of the job, by half percents";
  EXPECT_LE(told(), 101);
  EXPECT_DOUBLE_EQ(job_.feed->progress()->fraction, .6) << "who asks is told all";
}

TEST_F(FeedOutputs, TellEachStageAndChartThatBegins) {
  for (const Index chart : {0, 1, 2})
    for (const Stage stage : {Stage::solve, Stage::untangle})
      output_.stage({.stage = stage, .chart = chart, .chart_count = 3, .fraction = .5});
  EXPECT_EQ(told(), 6);
}

TEST_F(FeedOutputs, WriteNothingBeyondTheQuota) {
  most_ = 10;
  output_.result("obj", "123456");
  EXPECT_EQ(error_of([&] { output_.file("uv.bin", "12345"); }).code(), ErrorCode::quota_exceeded);
  EXPECT_FALSE(std::filesystem::exists(blobs_.path("j_1", "uv.bin")));
  output_.file("uv.bin", "1234");
  FeedOutput again(job_, blobs_, {reservation_, most_bytes_});
  again.result("obj", "1234567890");
}

TEST_F(FeedOutputs, WaitForAStoreThatCannotBeReachedUntilTheJobIsStopped) {
  int asked = 0;
  const std::function<std::int64_t(const std::string&)> away =
      [&](const std::string&) -> std::int64_t {
    if (++asked < 3 || job_.stop.stop_requested())
      throw StoreAway(StorePart::database, "gone", false);
    return 0;
  };
  FeedOutput patient(job_, blobs_, {reservation_, away});
  patient.file("uv.bin", "1234");
  EXPECT_EQ(asked, 3);
  EXPECT_TRUE(std::filesystem::exists(blobs_.path("j_1", "uv.bin")));
  job_.request_stop(StopCause::cancelled);
  EXPECT_EQ(error_of([&] { patient.file("more.bin", "1"); }).code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace unwrapd::server::jobs
