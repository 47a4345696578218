// What jobs share: made once, whoever asks; the same maps as alone; never more memory than allowed.
#include "server/work/solver_cache.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <thread>
#include <vector>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "server/work/thread_executor.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::server::work {
namespace {

constexpr std::int64_t kPlenty = std::int64_t{1} << 40;

Digest key(char name) { return Digest{std::byte(name)}; }

SharedCache::Made number(int value, std::size_t bytes = 10) {
  return {std::make_shared<const int>(value), bytes};
}

int ask(SolverCache& cache, char name, int value, std::size_t bytes = 10) {
  return *std::static_pointer_cast<const int>(
      cache.obtain(key(name), [&] { return number(value, bytes); }, {}));
}

TEST(SolverCache, GivesWhatWasMadeBefore) {
  SolverCache cache({.cache_bytes = 100, .job_bytes = kPlenty}, 1);
  EXPECT_EQ(ask(cache, 'a', 1), 1);
  EXPECT_EQ(ask(cache, 'b', 2), 2);
  EXPECT_EQ(ask(cache, 'a', 3), 1);
  const CacheCounters counters = cache.counters();
  EXPECT_EQ(counters.hits, 1U);
  EXPECT_EQ(counters.misses, 2U);
  EXPECT_EQ(counters.entries, 2U);
  EXPECT_EQ(counters.bytes, 20U);
}

TEST(SolverCache, DropsWhatWasNotUsedLongest) {
  SolverCache cache({.cache_bytes = 30, .job_bytes = kPlenty}, 1);
  for (char name : {'a', 'b', 'c', 'a', 'd'}) ask(cache, name, name);
  EXPECT_EQ(ask(cache, 'a', 0), 'a');  // used since
  EXPECT_EQ(ask(cache, 'b', 0), 0);    // dropped for d
  EXPECT_LE(cache.counters().bytes, 30U);
  EXPECT_GE(cache.counters().evictions, 2U);
}

TEST(SolverCache, ShrinksToWhatWasUsedLast) {
  SolverCache cache({.cache_bytes = 100, .job_bytes = kPlenty}, 1);
  for (char name : {'a', 'b', 'c', 'a'}) ask(cache, name, name);
  cache.shrink_to(29);
  EXPECT_EQ(cache.counters().bytes, 20U);
  EXPECT_EQ(ask(cache, 'a', 0), 'a');
  EXPECT_EQ(ask(cache, 'c', 0), 'c');
  cache.shrink_to(0);
  EXPECT_EQ(cache.counters().entries, 0U);
  EXPECT_EQ(ask(cache, 'a', 1), 1);
}

TEST(SolverCache, HandsOutWhatIsTooLargeToKeep) {
  SolverCache cache({.cache_bytes = 30, .job_bytes = kPlenty}, 1);
  ask(cache, 'b', 7);
  EXPECT_EQ(ask(cache, 'a', 1, 31), 1);
  EXPECT_EQ(ask(cache, 'a', 2, 31), 2);
  EXPECT_EQ(ask(cache, 'b', 8), 7);  // what fits stays
  EXPECT_EQ(cache.counters().bytes, 10U);
}

TEST(SolverCache, MakesOnceForJobsThatAskAtOnce) {
  for (std::int64_t room : {kPlenty, std::int64_t{0}}) {  // kept or not
    SolverCache cache({.cache_bytes = room, .job_bytes = kPlenty}, 1);
    constexpr int kJobs = 3;
    std::latch all_here(kJobs);
    std::atomic<int> made = 0;
    std::vector<int> got(kJobs);
    std::vector<std::jthread> jobs;
    for (int& result : got)
      jobs.emplace_back([&] {
        all_here.count_down();
        result = *std::static_pointer_cast<const int>(cache.obtain(key('a'),
                                                                   [&] {
                                                                     all_here.wait();
                                                                     return number(++made);
                                                                   },
                                                                   {}));
      });
    jobs.clear();
    EXPECT_TRUE(room == 0 || got == std::vector<int>(kJobs, 1));
    EXPECT_EQ(cache.counters().misses, std::uint64_t(made));
    EXPECT_EQ(cache.counters().hits, std::uint64_t(kJobs - made));
  }
}

TEST(SolverCache, HandsOutTheRightThingHoweverManyAskForMoreThanItKeeps) {
  for (std::int64_t room : {0, 10, 20}) {
    SolverCache cache({.cache_bytes = room, .job_bytes = kPlenty}, 1);
    std::atomic<int> wrong = 0;
    std::vector<std::jthread> jobs;
    for (int job = 0; job < 4; ++job)
      jobs.emplace_back([&, job] {
        for (int k = 0; k < 500; ++k) {
          const int name = 'a' + (k + job) % 3;
          const auto make = [&] {
            std::this_thread::yield();  // others come to wait
            return number(name);
          };
          const auto got = cache.obtain(key(static_cast<char>(name)), make, {});
          if (*std::static_pointer_cast<const int>(got) != name) ++wrong;
        }
      });
    jobs.clear();
    EXPECT_EQ(wrong, 0);
    EXPECT_LE(cache.counters().bytes, static_cast<std::size_t>(room));
    EXPECT_EQ(cache.counters().bytes, 10 * cache.counters().entries);
  }
}

TEST(SolverCache, LetsTheNextOneTryWhereMakingFailed) {
  SolverCache cache({.cache_bytes = 30, .job_bytes = kPlenty}, 1);
  const auto fail = []() -> SharedCache::Made { throw Error(ErrorCode::solver_failed, "no"); };
  EXPECT_THROW(cache.obtain(key('a'), fail, {}), Error);
  EXPECT_EQ(ask(cache, 'a', 5), 5);
}

TEST(SolverCache, LetsAnotherMakeItWhereTheMakerIsStopped) {
  SolverCache cache({.cache_bytes = 30, .job_bytes = kPlenty}, 1);
  std::latch is_making(1);
  const auto is_stopped = [&]() -> SharedCache::Made {
    is_making.count_down();
    throw Error(ErrorCode::cancelled, "stopped");
  };
  std::jthread maker([&] { EXPECT_THROW(cache.obtain(key('a'), is_stopped, {}), Error); });
  is_making.wait();
  EXPECT_EQ(ask(cache, 'a', 5), 5);  // whether it waited for the other or came after it
}

TEST(SolverCache, LetsAJobStopThatWaitsForAnother) {
  SolverCache cache({.cache_bytes = 30, .job_bytes = kPlenty}, 1);
  std::latch is_making(1), may_end(1);
  std::jthread maker([&] {
    cache.obtain(key('a'),
                 [&] {
                   is_making.count_down();
                   may_end.wait();
                   return number(1);
                 },
                 {});
  });
  is_making.wait();
  std::stop_source stop;
  std::jthread stopper([&] { stop.request_stop(); });
  const auto never = []() -> SharedCache::Made { throw std::logic_error("made twice"); };
  EXPECT_THROW(cache.obtain(key('a'), never, stop.get_token()), Error);
  may_end.count_down();
  maker.join();
  EXPECT_EQ(ask(cache, 'a', 2), 1);
}

TEST(SolverCache, TellsBytesApart) {
  const SolverCache cache({}, 1);
  const auto digest = [&](std::string_view text) {
    return cache.digest(std::as_bytes(std::span(text)));
  };
  EXPECT_EQ(digest("ab"), digest("ab"));
  EXPECT_NE(digest("ab"), digest("ba"));
  EXPECT_NE(digest(""), digest(std::string_view("\0", 1)));
}

TEST(SolverCache, GivesAJobItsShareOfTheMachineWhereNoLimitIsSet) {
  const SolverCache one({}, 1), four({}, 4);
  EXPECT_GT(one.memory_limit(), std::size_t{1} << 26);
  EXPECT_EQ(four.memory_limit(), one.memory_limit() / 4);
}

std::vector<UvMap> maps_of(const std::vector<Surface>& surfaces, const UnwrapOptions& options,
                           SolverCache* cache) {
  ThreadExecutor executor(2, cache);
  std::vector<UvMap> maps;
  for (UnwrappedSurface& surface : unwrap(surfaces, options, {}, executor).surfaces)
    maps.push_back(std::move(surface.uv));
  return maps;
}

TEST(SharedCore, GivesTheMapsThatEachJobWouldMakeAlone) {
  SolverCache cache({.cache_bytes = kPlenty, .job_bytes = kPlenty}, 1);
  const TriMesh mesh = shapes::random_disk(15, 3);
  TriMesh bent = mesh;  // the same faces
  for (Vec3& p : bent.positions) p.z() += 0.2 * p.x() * p.x();
  std::vector<UnwrapOptions> jobs(7);
  jobs[1].method = Method::hybrid, jobs[1].lambda = 0.1;
  jobs[2].method = Method::asap;
  jobs[3].method = Method::asap, jobs[3].pins = Pins::spectral;
  jobs[4].initial = InitialMap::mean_value;
  jobs[5].initial = InitialMap::tutte;
  jobs[6].initial = InitialMap::lscm;
  for (const TriMesh& each : {mesh, bent, mesh}) {
    const std::vector<Surface> surfaces{shapes::surface_of(each)};
    for (const UnwrapOptions& options : jobs)
      EXPECT_EQ(maps_of(surfaces, options, &cache), maps_of(surfaces, options, nullptr));
  }
  const CacheCounters counters = cache.counters();
  EXPECT_GT(counters.hits, counters.misses);
}

TEST(SharedCore, KeepsNothingThatHearsTheStopOfTheJobThatMadeIt) {
  SolverCache cache({.cache_bytes = kPlenty, .job_bytes = kPlenty}, 1);
  const std::vector<Surface> surfaces{shapes::surface_of(shapes::random_disk(15, 3))};
  std::stop_source source;
  ThreadExecutor executor(2, &cache);
  unwrap(surfaces, {}, {.on_stage = {}, .on_iteration = {}, .stop = source.get_token()}, executor);
  source.request_stop();  // too late for that job
  for (const Method method : {Method::arap, Method::asap, Method::slim})
    EXPECT_EQ(maps_of(surfaces, {.method = method}, &cache),
              maps_of(surfaces, {.method = method}, nullptr));
}

TEST(SharedCore, RefusesAJobThatNeedsMoreThanItMay) {
  const std::vector<Surface> surfaces{shapes::surface_of(shapes::random_disk(60, 3))};
  for (Method method : {Method::arap, Method::asap, Method::slim, Method::abf}) {
    SolverCache cache({.cache_bytes = kPlenty, .job_bytes = 6'000'000}, 1);
    UnwrapOptions options;
    options.method = method;
    try {
      maps_of(surfaces, options, &cache);
      ADD_FAILURE() << "method " << int(method) << " was not refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::too_much_memory);
      EXPECT_NE(std::string(e.what()).find(" MB"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace unwrapd::server::work
