// What those who run the server see of it: probes, metrics, traces, the log of requests.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "server/base/metrics.hpp"
#include "server/base/trace.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/http/http_probe.hpp"
#include "server/store/data_directory.hpp"

namespace unwrapd::server::routes {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kParent = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
constexpr const char* kTraceId = "4bf92f3577b34da6a3ce929d0e0e4736";

TEST(Trace, ATraceparentIsContinuedWithASpanOfOurOwn) {
  const Trace trace = continue_trace(kParent);
  EXPECT_EQ(trace.id, kTraceId);
  EXPECT_NE(trace.span, "00f067aa0ba902b7");
  EXPECT_EQ(to_traceparent(trace), "00-" + std::string(kTraceId) + "-" + trace.span + "-01");
  const std::string later = "cc" + std::string(kParent).substr(2) + "-what-is-to-come";
  EXPECT_EQ(continue_trace(later).id, kTraceId);
  EXPECT_EQ(continue_trace(to_traceparent(trace)).id, kTraceId);
}

TEST(Trace, WhatIsNoTraceparentBeginsANewTrace) {
  const std::string good = kParent;
  for (const std::string& other :
       {std::string(), std::string("x"), good + "-x", good.substr(1), good.substr(0, 54),
        "ff" + good.substr(2), "00-" + std::string(32, '0') + good.substr(35),
        good.substr(0, 36) + std::string(16, '0') + "-01", "00-4BF9" + good.substr(7),
        good.substr(0, 35) + "_" + good.substr(36)}) {
    const Trace trace = continue_trace(other);
    EXPECT_NE(trace.id, kTraceId) << other;
    EXPECT_EQ(continue_trace(to_traceparent(trace)).id, trace.id) << other;
  }
}

TEST(Trace, LinesOfAThreadThatWorksForATraceTellIt) {
  testing::internal::CaptureStderr();
  const Log log(LogLevel::info, LogFormat::text);
  {
    const TraceScope outer("a");
    {
      const TraceScope inner("b");
      log.info("within", {{"n", 1}});
    }
    std::jthread([&] { log.info("elsewhere"); }).join();
  }
  EXPECT_THAT(
      testing::internal::GetCapturedStderr(),
      ContainsRegex("^[^ ]+Z info \"within\" trace=\"b\" n=1\n[^ ]+ info \"elsewhere\"\n$"));
}

TEST(Metrics, AHistogramIsCumulativeAndLabelsAreEscaped) {
  Metrics metrics;
  for (const double seconds : {0.005, 0.006, 2000.0})
    metrics.observe(Metric::request_seconds, {{"route", "a\"\\\nb"}}, seconds);
  metrics.count(Metric::errors, {{"code", "x"}});
  metrics.count(Metric::errors, {{"code", "x"}}, 2);
  const std::string text = metrics.text();
  const std::string bucket = R"(unwrapd_request_seconds_bucket{route="a\"\\\nb",le=)";
  for (const char* line : {R"("0.005"} 1)", R"("0.025"} 2)", R"("900"} 2)", R"("+Inf"} 3)"})
    EXPECT_THAT(text, HasSubstr(bucket + line + "\n"));
  EXPECT_THAT(text, AllOf(HasSubstr("unwrapd_errors_total{code=\"x\"} 3\n"),
                          HasSubstr("unwrapd_iterations_total 0\n"),
                          Not(HasSubstr("unwrapd_jobs_ended_total"))));
}

class Operations : public RunningServer {
 protected:
  Operations() { config_.admin = http::Address{"127.0.0.1", 0}; }

  [[nodiscard]] httplib::Client admin() const {
    return httplib::Client("127.0.0.1", *service_->admin_port());
  }
  [[nodiscard]] std::string metrics() const { return admin().Get("/metrics")->body; }
  /// The number of a line of the metrics.
  [[nodiscard]] double metric(const std::string& name) const {
    const std::string text = "\n" + metrics();
    const std::size_t at = text.find("\n" + name + " ");
    return at == std::string::npos ? -1 : std::stod(text.substr(at + name.size() + 2));
  }
};

TEST_F(Operations, TheAdminPortAnswersProbesAndNothingElse) {
  start();
  for (const char* path : {"/healthz", "/readyz", "/version", "/metrics"})
    EXPECT_EQ(admin().Get(path)->status, 200) << path;
  EXPECT_EQ(api::Json::parse(admin().Get("/version")->body).at("name"), "unwrapd");
  expect_problem(admin().Get("/v1/limits"), 404, "not_found");
  expect_problem(client().Get("/metrics"), 404, "not_found");
  expect_problem(admin().Post("/healthz"), 405, "method_not_allowed");
}

TEST_F(Operations, TheServerIsNotReadyWhileNothingCanBeStored) {
  start();
  database::SqliteDatabase behind(config_.data / store::kStoreFile);
  behind.run("ALTER TABLE jobs RENAME TO away");
  const httplib::Headers bypass_cache = {{"Cache-Control", "no-cache"}};
  expect_problem(client().Post("/v1/jobs", bypass_cache, grid_obj(2), "model/obj"), 500,
                 "storage_failed");
  expect_problem(admin().Get("/readyz"), 500, "storage_failed");
  expect_problem(client().Get("/readyz"), 500, "storage_failed");
  EXPECT_EQ(admin().Get("/healthz")->status, 200);
  behind.run("ALTER TABLE away RENAME TO jobs");
  EXPECT_EQ(admin().Get("/readyz")->status, 200);
  await_state(submit(), "succeeded");
}

/// What is stored may take so much that the mesh fits and its result does not.
TEST_F(Operations, TheServerIsNotReadyWhileJobsWaitForRoomOnTheDisk) {
  config_.workers = 1;
  config_.disk.max_bytes = static_cast<std::int64_t>(grid_obj(4).size()) * 3 / 2;
  start();
  EXPECT_EQ(client().Get("/readyz")->status, 200);
  const std::string waiting = submit();
  await([&] { return client().Get("/readyz")->status != 200; });
  const auto refused = admin().Get("/readyz");
  expect_problem(refused, 507, "storage_full");
  EXPECT_GT(std::stoi(refused->get_header_value("Retry-After")), 0);
  EXPECT_EQ(admin().Get("/healthz")->status, 200);
  EXPECT_EQ(client().Delete("/v1/jobs/" + waiting)->status, 202);
  await([&] { return admin().Get("/readyz")->status == 200; });
}

TEST_F(Operations, TheServerIsNotReadyWithoutItsFiles) {
  start();
  for (const char* name : {"blobs", store::kStoreFile}) {
    const auto place = config_.data / name, away = config_.data / "away";
    std::filesystem::rename(place, away);
    expect_problem(client().Get("/readyz"), 500, "storage_failed");
    std::filesystem::rename(away, place);
    EXPECT_EQ(client().Get("/readyz")->status, 200) << name;
  }
}

TEST_F(Operations, TheHealthCheckOfTheProgramAsksTheAdminPort) {
  start();
  const http::Address address{"0.0.0.0", *service_->admin_port()};
  EXPECT_EQ(http::probe(address), 0);
  service_->drain();
  testing::internal::CaptureStderr();
  EXPECT_EQ(http::probe(address), 1);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("no health at 0.0.0.0:"));
}

TEST_F(Operations, MetricsTellWhatHasHappened) {
  config_.workers = 1;
  start();
  // A job is seen to end before its end is counted.
  const auto expect_soon = [this](const std::string& name) {
    await([&] { return metric(name) == 1; });
  };
  const std::string done = submit("?stop.iterations=7");
  await_state(done, "succeeded");
  EXPECT_EQ(metric("unwrapd_iterations_total"), 7);
  expect_soon("unwrapd_jobs_ended_total{state=\"succeeded\"}");
  for (const char* stage : {"queue", "read", "solve", "write"})
    expect_soon(std::string("unwrapd_job_stage_seconds_count{stage=\"") + stage + "\"}");
  EXPECT_EQ(metric("unwrapd_jobs{state=\"queued\"}"), 0);
  const std::string running = submit_endless();
  const std::string waiting = submit();
  await_state(running, "running");
  EXPECT_EQ(metric("unwrapd_jobs{state=\"running\"}"), 1);
  EXPECT_EQ(metric("unwrapd_jobs{state=\"queued\"}"), 1);
  client().Delete("/v1/jobs/" + running);
  await_state(waiting, "succeeded");
  expect_soon("unwrapd_jobs_ended_total{state=\"cancelled\"}");
  const httplib::Headers wait = {{"Prefer", "wait=60"}};
  client().Post("/v1/jobs", wait, "v 0 0 zero\n", "model/obj");
  expect_soon("unwrapd_jobs_ended_total{state=\"failed\"}");
  expect_soon("unwrapd_job_errors_total{code=\"malformed_obj\"}");
  client().Post("/v1/jobs?method=none", "x", "model/obj");
  await([this] { return metric("unwrapd_errors_total{code=\"invalid_option\"}") == 1; });
  const std::string refused = R"({method="POST",route="/v1/jobs",status="422"})";
  await([&] { return metric("unwrapd_requests_total" + refused) == 1; });
  EXPECT_GT(metric("unwrapd_sent_bytes_total"), 1000);
  EXPECT_GT(metric("process_resident_memory_bytes"), 1e6);
}

/// How many threads of this process are so nice, or nicer.
int nice_threads(int least) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const int thread = std::stoi(entry.path().filename());
    if (::getpriority(PRIO_PROCESS, static_cast<id_t>(thread)) >= least) ++count;
  }
  return count;
}

TEST_F(Operations, ThreadsThatWorkAreNiceToThoseThatAnswer) {
  const int own = ::getpriority(PRIO_PROCESS, 0);
  const int others = nice_threads(own + 1);
  config_.workers = 2;
  config_.threads = 3;
  start();
  await_state(submit(), "succeeded");
  await([&] { return nice_threads(own + 1) == others + 6; });
}

TEST_F(Operations, CachesTellWhatTheyWereAskedForAndWhatTheyMade) {
  start();
  const std::string id = submit();
  await_state(id, "succeeded");
  const auto count = [&](const std::string& cache, const std::string& outcome) {
    return metric("unwrapd_cache_requests_total{cache=\"" + cache + "\",outcome=\"" + outcome +
                  "\"}");
  };
  const auto made = [&](const std::string& cache) {
    return metric("unwrapd_cache_made_bytes_total{cache=\"" + cache + "\"}");
  };
  EXPECT_EQ(made("result") + made("picture"), 0);
  const std::size_t glb = get(id, "result", {{"Accept", "model/gltf-binary"}})->body.size();
  EXPECT_EQ(made("result"), glb);
  get(id, "result", {{"Accept", "model/gltf-binary"}});
  EXPECT_EQ(std::pair(count("result", "hit"), count("result", "miss")), std::pair(1.0, 1.0));
  const std::size_t png = get(id, "layout.png?size=64")->body.size();
  get(id, "layout.png?size=64");
  EXPECT_EQ(std::pair(count("picture", "hit"), count("picture", "miss")), std::pair(1.0, 1.0));
  EXPECT_EQ(made("picture"), png);
  EXPECT_GT(metric("unwrapd_cache_bytes{cache=\"solver\"}"), 0);
  const double stored = metric("unwrapd_stored_bytes");
  EXPECT_GT(stored, static_cast<double>(glb + png));
  client().Delete("/v1/jobs/" + id);
  EXPECT_EQ(metric("unwrapd_stored_bytes"), 0);
}

TEST_F(Operations, PromtoolFindsTheMetricsWellFormed) {
  if (std::system("command -v promtool >/dev/null") != 0)
    GTEST_SKIP() << "promtool is not installed (Debian package prometheus)";
  start();
  await_state(submit(), "succeeded");
  const std::string file = dir_.path() / "metrics.txt";
  std::ofstream(file) << metrics();
  EXPECT_EQ(std::system(("promtool check metrics <" + file).c_str()), 0) << metrics();
}

TEST_F(Operations, ATraceGoesFromTheRequestIntoTheLogAndTheAnswer) {
  testing::internal::CaptureStderr();
  const Log log(LogLevel::info);
  service_ = std::make_unique<Service>(config_, log);
  const auto answer = client().Post("/v1/jobs?lambda=1&method=hybrid", {{"traceparent", kParent}},
                                    grid_obj(3), "model/obj");
  const std::string id = api::Json::parse(answer->body).at("id");
  await_state(id, "succeeded");
  service_.reset();
  EXPECT_EQ(continue_trace(answer->get_header_value("traceparent")).id, kTraceId);
  std::istringstream lines(testing::internal::GetCapturedStderr());
  std::map<std::string, api::Json> of_trace;
  for (std::string line; std::getline(lines, line);) {
    const api::Json parsed = api::Json::parse(line);
    if (parsed.value("trace", "") == kTraceId) of_trace[parsed.at("event")] = parsed;
  }
  for (const char* event : {"job queued", "job started", "job ended"})
    EXPECT_EQ(of_trace[event].value("job", ""), id) << event;
  const api::Json request = of_trace["request"];
  EXPECT_EQ(request.value("path", ""), "/v1/jobs");  // without the query
  EXPECT_EQ(request.value("status", 0), 202);
  EXPECT_EQ(request.value("client", ""), "127.0.0.1");
  EXPECT_EQ(request.value("received", 0U), grid_obj(3).size());
}

TEST_F(Operations, RequestsThatCannotBeReadAreLoggedAndCountedAsWell) {
  start();
  httplib::Client raw = client();
  raw.set_keep_alive(false);
  expect_problem(raw.Get("/" + std::string(9000, 'a')), 431, "headers_too_large");
  await([this] { return metric("unwrapd_errors_total{code=\"headers_too_large\"}") == 1; });
}

}  // namespace
}  // namespace unwrapd::server::routes
