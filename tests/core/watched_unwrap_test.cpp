// A whole job watched in units of its work: blocks handed to the executor, and events told.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

using namespace shapes;

/// Runs jobs, counts their steps, and asks for a stop at one of them.
class Watched final : public Executor {
 public:
  explicit Watched(long stop_at = 0) : stop_at_(stop_at) {}

  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    for (int block = 0; block < block_count; ++block) {
      step();
      body(block);
    }
  }

  /// Whether the job was cancelled.
  bool run(const std::vector<Surface>& surfaces, const UnwrapOptions& options) {
    Progress progress{.on_stage = [&](const StageEvent& e) { tell(e.fraction); },
                      .on_iteration = [&](const IterationEvent& e) { tell(e.fraction); },
                      .stop = source_.get_token()};
    try {
      unwrap(surfaces, options, progress, *this);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
      return true;
    }
    return false;
  }

  long steps = 0;
  long longest_still = 0;  ///< steps while the fraction stood still
  double fraction = 0;

 private:
  void step() {
    if (++steps == stop_at_) source_.request_stop();
    longest_still = std::max(longest_still, steps - moved_at_);
  }

  void tell(double now) {
    EXPECT_GE(now, fraction);
    EXPECT_LE(now, 1);
    step();
    if (now > fraction) moved_at_ = steps;
    fraction = now;
  }

  std::stop_source source_;
  long stop_at_, moved_at_ = 0;
};

struct Job {
  const char* name;
  std::vector<Surface> surfaces;
  UnwrapOptions options;
};

/// Every stage in at most some tenths of a second.
std::vector<Job> small_jobs() {
  std::vector<TriMesh> boxes;
  for (int k = 0; k < 6; ++k) boxes.push_back(moved(cube(), {2.0 * k, 0, 0}));
  return {{"bar with two handles", {surface_of(pierced_bar(2))}, {}},
          {"boxes", {surface_of(merged(boxes))}, {}},
          {"several maps of a cap",
           {surface_of(sphere_cap(24, 12, 2))},
           {.method = Method::hybrid, .lambda_curve = {0.01, 0.1, 1}}}};
}

std::vector<Job> jobs() {
  std::vector<Job> all = small_jobs();
  all.push_back({"torus", {surface_of(torus(32, 16))}, {}});
  all.push_back({"two surfaces", {surface_of(sphere(3)), surface_of(cone(20, 5))}, {}});
  return all;
}

TEST(WatchedUnwrap, EndsSoonAfterItIsToldToWhereverItIs) {
  constexpr long kMostStepsLeft = 16;  // what is under way: a batch of unions, a sweep
  for (const Job& job : small_jobs()) {
    Watched whole;
    EXPECT_FALSE(whole.run(job.surfaces, job.options)) << job.name;
    for (const long share : {0, 3, 5}) {
      const long moment = 1 + whole.steps * share / 6;
      Watched stopped(moment);
      EXPECT_TRUE(stopped.run(job.surfaces, job.options)) << job.name << ' ' << moment;
      EXPECT_LE(stopped.steps, moment + kMostStepsLeft) << job.name << ' ' << moment;
    }
  }
}

TEST(WatchedUnwrap, MovesOnInItsProgressAllTheTime) {
  for (const Job& job : jobs()) {
    Watched whole;
    whole.run(job.surfaces, job.options);
    EXPECT_LE(whole.longest_still, whole.steps / 25 + 8) << job.name << " of " << whole.steps;
  }
}

}  // namespace
}  // namespace unwrapd
