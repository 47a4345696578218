// Jobs that share while they run: each thing made once, told of to all, and no job harmed by what
// becomes of another.
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <thread>

#include "core/base/error.hpp"
#include "tests/server/shared_jobs.hpp"

namespace unwrapd::server::jobs {
namespace {

/// One chart, two boundaries: a second start counts.
Surfaces ring() { return {shapes::surface_of(bent(shapes::annulus(14, 4), 0.5))}; }

TEST(JobsAtOnce, MakeEverythingOnce) {
  const Surfaces mesh{shapes::surface_of(shapes::sphere(0))};
  work::SolverCache alone(kRoomForAll, 1), shared(kRoomForAll, 1);
  const std::string expected = answer(mesh, {}, &alone);
  constexpr int kJobs = 4;
  std::latch all_here(kJobs);
  std::vector<std::string> answers(kJobs);
  std::vector<std::jthread> jobs;
  for (std::string& own : answers)
    jobs.emplace_back([&] {
      all_here.arrive_and_wait();
      own = answer(mesh, {}, &shared, 2);
    });
  jobs.clear();
  EXPECT_TRUE(answers == std::vector(kJobs, expected));
  EXPECT_EQ(shared.counters().misses, alone.counters().misses);
}

/// A job that is cancelled at the first event which is_last() accepts, once others may wait for it.
void cancelled_job(const Surfaces& mesh, work::SolverCache& cache, std::latch& may_join,
                   const std::function<bool(Stage)>& is_last) {
  std::stop_source source;
  const Progress progress{.on_stage =
                              [&](const StageEvent& event) {
                                if (!is_last(event.stage) || source.stop_requested()) return;
                                may_join.arrive_and_wait();
                                source.request_stop();
                              },
                          .on_iteration = {},
                          .stop = source.get_token()};
  try {
    answer(mesh, {}, &cache, 1, progress);
    ADD_FAILURE() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

TEST(JobsAtOnce, AreAnsweredThoughTheOneThatMakesIsCancelled) {
  const Surfaces body{shapes::surface_of(shapes::sphere(0))};
  for (const Surfaces& mesh : {body, ring()})
    for (const Stage last : {Stage::segment, Stage::factor, Stage::solve}) {
      if ((last == Stage::segment) != (mesh.front().mesh.faces == body.front().mesh.faces))
        continue;  // a ring is not taken apart; a body's charts are too many to wait at each
      work::SolverCache cache(kRoomForAll, 1);
      std::latch may_join(2);
      std::jthread maker([&] {
        cancelled_job(mesh, cache, may_join, [&](Stage stage) { return stage == last; });
      });
      bool has_joined = false;
      const Progress joins{.on_stage =
                               [&](const StageEvent&) {
                                 if (!std::exchange(has_joined, true)) may_join.arrive_and_wait();
                               },
                           .on_iteration = {},
                           .stop = {}};
      const std::string shared = answer(mesh, {}, &cache, 1, joins);
      EXPECT_TRUE(shared == answer(mesh, {}, nullptr)) << static_cast<int>(last);
    }
}

TEST(JobsAtOnce, FailAsTheyWouldAlone) {
  work::SolverCache cache(kRoomForAll, 1);
  const Surfaces nothing{shapes::surface_of({})};
  for (int again : {1, 2}) {
    try {
      answer(nothing, {}, &cache);
      ADD_FAILURE() << again;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::no_triangles);
    }
  }
  EXPECT_EQ(cache.counters().entries, 0U);
}

TEST(JobsThatFollow, HearOfSegmentingWhereTheySegment) {
  work::SolverCache cache(kRoomForAll, 1);
  const Surfaces body{shapes::surface_of(shapes::sphere(0))};
  std::vector<int> segment_events(2, 0);
  for (int& events : segment_events) {
    double last = 0;
    const Progress progress{
        .on_stage =
            [&](const StageEvent& event) {
              events += event.stage == Stage::segment || event.stage == Stage::merge ? 1 : 0;
              EXPECT_GE(event.fraction, last);
              last = event.fraction;
            },
        .on_iteration = {},
        .stop = {}};
    answer(body, {}, &cache, 2, progress);
  }
  EXPECT_GT(segment_events[0], 0);
  EXPECT_EQ(segment_events[1], 0);
}

using Told = std::vector<std::vector<double>>;

/// What a job tells of its iterations.
Told iterations_of(const Surfaces& surfaces, const UnwrapOptions& options,
                   work::SolverCache* cache) {
  Told told;
  const auto on_iteration = [&](const IterationEvent& e) {
    told.push_back({double(e.chart), double(e.iteration), e.energy, e.rel_change, e.angle, e.area,
                    double(e.flipped), e.fraction, e.lambda.value_or(-1)});
  };
  answer(surfaces, options, cache, 1, {.on_stage = {}, .on_iteration = on_iteration, .stop = {}});
  return told;
}

TEST(JobsThatFollow, HearOfEveryIterationEvenWhereNoneIsMade) {
  work::SolverCache cache(kRoomForAll, 1);
  const Surfaces disk{shapes::surface_of(shapes::random_disk(6, 3))};
  const Surfaces both{disk.front(), shapes::surface_of(bent(disk.front().mesh, 0.2))};
  std::vector<UnwrapOptions> jobs(4);
  jobs[1].stop.iterations = 4;
  jobs[2].method = Method::hybrid, jobs[2].lambda_curve = {0.1, 1, 10};
  jobs[3].method = Method::slim, jobs[3].stop.iterations = 3;
  for (const UnwrapOptions& options : jobs) {
    answer(disk, options, &cache);  // one that nobody follows
    for (const Surfaces& mesh : {disk, both, disk}) {
      const Told alone = iterations_of(mesh, options, nullptr);
      EXPECT_FALSE(alone.empty());
      EXPECT_EQ(iterations_of(mesh, options, &cache), alone);
    }
  }
}

}  // namespace
}  // namespace unwrapd::server::jobs
