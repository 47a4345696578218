// Jobs a second that the store takes in and ends, on SQLite and, where TEST_POSTGRESQL names
// a PostgreSQL server, there: unwrapd_store [JOBS]. The engines take turns; of each the median
// round is told. Each job is three commits: inserted, taken, finished. Then how many jobs of a
// thousand owners are claimed a second, each by the owner whose turn it is.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "server/store/data_directory.hpp"
#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server {
namespace {

constexpr int kRounds = 5;
constexpr int kUsualJobs = 2000;
constexpr int kOwners = 1000;

double seconds_of(const std::function<void()>& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

struct Engine {
  Engine(std::string engine, const database::DatabaseAddress& address)
      : name(std::move(engine)), store(address) {}

  void round(int jobs) {
    const int first = next;
    const double inserting = seconds_of([&] {
      for (; next < first + jobs; ++next) {
        store::JobRecord job;
        job.id = "j_" + std::to_string(next);
        job.options = {{"method", "arap"}};
        job.request_key = job.id;
        store.insert(job);
      }
    });
    const double ending = seconds_of([&] {
      while (const auto job = store.take(""))
        store.finish(*job, {.result_format = "glb", .problem = {}, .finished_ms = 1});
    });
    inserts.push_back(jobs / inserting);
    ends.push_back(jobs / ending);
  }

  /// Claims a second.
  double claim_in_turn() {
    for (int owner = 0; owner < kOwners; ++owner) {
      store::JobRecord job;
      job.id = "j_" + std::to_string(next++);
      job.owner = "k_" + std::to_string(owner);
      job.options = {{"method", "arap"}};
      store.insert(job);
    }
    int claimed = 0;
    const double claiming = seconds_of([&] {
      while (const auto owner = store.next_owner(1000)) claimed += store.take(*owner).has_value();
    });
    return claimed / claiming;
  }

  std::string name;
  store::JobStore store;
  int next = 0;
  std::vector<double> inserts, ends;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

int run(int jobs) {
  const TempDir dir;
  std::vector<std::unique_ptr<Engine>> engines;
  engines.push_back(std::make_unique<Engine>("sqlite", dir.path() / store::kStoreFile));
  if (const database::PostgresAddress postgres = postgres_of(dir.path()); !postgres.url.empty())
    engines.push_back(std::make_unique<Engine>("postgresql", postgres));
  for (int round = 0; round < kRounds; ++round)
    for (const auto& engine : engines) engine->round(jobs / kRounds);
  for (const auto& engine : engines)
    std::printf("%-12s %8.0f inserts/s %8.0f taken and finished/s %8.0f claimed in turn/s\n",
                engine->name.c_str(), median(engine->inserts), median(engine->ends),
                engine->claim_in_turn());
  return 0;
}

}  // namespace
}  // namespace unwrapd::server

int main(int argc, char** argv) {
  return unwrapd::server::run(argc > 1 ? std::atoi(argv[1]) : unwrapd::server::kUsualJobs);
}
