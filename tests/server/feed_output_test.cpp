#include "server/feed_output.hpp"

#include <gtest/gtest.h>

#include "temp_dir.hpp"

namespace unwrapd::server {
namespace {

/// Events in the order told, of a ring that forgets none of them.
class FeedOutputs : public testing::Test {
 protected:
  FeedOutputs() { job_.feed = std::make_shared<JobFeed>(0, 100'000); }

  [[nodiscard]] std::int64_t told() const { return job_.feed->next_seq() - 1; }

  TempDir dir_;
  BlobStore blobs_{dir_.path()};
  RunningJob job_;
  FeedOutput output_{job_, blobs_};
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

}  // namespace
}  // namespace unwrapd::server
