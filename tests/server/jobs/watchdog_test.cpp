// Jobs that do not stop when they are told to: the real server, whose work can be made deaf.
#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>

#include "core/base/error.hpp"
#include "server/work/run_job.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::jobs {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kDeafSize = 7;  // of the grids whose jobs hear nothing

class Deaf : public RunningServer {
 protected:
  Deaf() {
    config_.workers = 1;
    config_.grace_seconds = 0;
    config_.admin = http::Address{"127.0.0.1", 0};
  }
  ~Deaf() override {
    let_go();
    service_.reset();  // whose lost threads use the members
  }

  void start_deaf() {
    work::WorkerFunctions functions;
    functions.run = [this](const work::JobTask& task, const asset::Input& input,
                           work::JobOutput& output, const api::Limits& limits, Executor& executor) {
      if (input.document == deaf_document_) hear_nothing(output);
      return work::run_job(task, input, output, limits, executor);
    };
    service_ = std::make_unique<Service>(config_, log_, functions);
  }
  /// What it says afterwards comes too late.
  void hear_nothing(work::JobOutput& output) {
    std::unique_lock lock(mutex_);
    ++deaf_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return is_let_go_; });
    output.stage({.stage = Stage::write, .chart = 0, .chart_count = 0, .fraction = 1});
    try {
      output.file("uv.bin", "x");
    } catch (const Error& error) {
      refused_ += error.code() == ErrorCode::cancelled ? 1 : 0;
      throw;
    }
  }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_let_go_ = true;
    changed_.notify_all();
  }
  std::string submit_deaf() {
    const int before = deaf();
    std::string id = submit("", kDeafSize);
    await([&] { return deaf() > before; });
    return id;
  }
  int deaf() {
    const std::lock_guard lock(mutex_);
    return deaf_;
  }
  int refused() {
    const std::lock_guard lock(mutex_);
    return refused_;
  }
  [[nodiscard]] bool tells(const std::string& line) const {
    httplib::Client admin("127.0.0.1", *service_->admin_port());
    return ("\n" + admin.Get("/metrics")->body).find("\n" + line + "\n") != std::string::npos;
  }
  void expect_done(const std::string& id) { await_state(id, "succeeded"); }

 private:
  const std::string deaf_document_ = grid_obj(kDeafSize);
  std::mutex mutex_;
  std::condition_variable changed_;
  int deaf_ = 0, refused_ = 0;
  bool is_let_go_ = false;
};

TEST_F(Deaf, AJobThatDoesNotHearItsStopIsGivenUpAndItsWorkerReplaced) {
  start_deaf();
  EXPECT_TRUE(tells(R"(unwrapd_jobs_forced_total{ended="given_up"} 0)"));
  const std::string id = submit_deaf();
  EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 202);
  await_state(id, "cancelled");
  expect_done(submit());
  EXPECT_TRUE(tells(R"(unwrapd_jobs_forced_total{ended="given_up"} 1)"));
  EXPECT_TRUE(tells("unwrapd_lost_threads 1"));
  let_go();
  await([&] { return tells("unwrapd_lost_threads 0"); });
  EXPECT_EQ(refused(), 1);
  EXPECT_EQ(state(id), "cancelled");
  EXPECT_FALSE(std::filesystem::exists(dir_.path() / "blobs" / id));
  EXPECT_THAT(client().Get("/v1/jobs/" + id + "/events")->body, Not(HasSubstr("write")));
  expect_done(submit("", 5));
}

TEST_F(Deaf, AJobBeyondItsTimeIsEndedThoughItDoesNotStop) {
  config_.limits.max_job_seconds = 1;
  start_deaf();
  const std::string id = submit("", kDeafSize);
  await_state(id, "failed");
  EXPECT_EQ(job(id).at("problem").at("code"), "time_limit");
}

TEST_F(Deaf, NoMoreThreadsAreReplacedThanThereAreWorkers) {
  start_deaf();
  for (int lost = 1; lost <= 2; ++lost) {
    EXPECT_EQ(client().Get("/readyz")->status, 200);
    const std::string id = submit_deaf();
    EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 202);
    await_state(id, "cancelled");
    EXPECT_TRUE(tells("unwrapd_lost_threads " + std::to_string(lost)));
  }
  const std::string waits = submit();
  EXPECT_EQ(state(waits), "queued");
  expect_problem(client().Get("/readyz"), 500, "internal");  // no worker is left
  let_go();
  expect_done(waits);
  await([&] { return tells("unwrapd_lost_threads 0"); });
  EXPECT_EQ(client().Get("/readyz")->status, 200);
  expect_done(submit("", 5));
}

TEST_F(Deaf, AServerThatHasLostAThreadSaysSoAtItsEnd) {
  start_deaf();
  const std::string id = submit_deaf();
  EXPECT_EQ(client().Delete("/v1/jobs/" + id)->status, 202);
  await_state(id, "cancelled");
  EXPECT_FALSE(service_->drain());
}

}  // namespace
}  // namespace unwrapd::server::jobs
