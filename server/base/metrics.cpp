#include "server/base/metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <prometheus/text_serializer.h>

#include <filesystem>
#include <fstream>

#include "server/base/clock.hpp"

namespace unwrapd::server {
namespace {

using prometheus::MetricFamily;
using Type = prometheus::MetricType;

struct FamilyRow {
  Metric metric;
  const char* name;
  Type type;
  const char* help;
};

constexpr std::array kFamilies = {
    FamilyRow{Metric::build_info, "unwrapd_build_info", Type::Gauge,
              "1, with the version as a label."},
    FamilyRow{Metric::requests, "unwrapd_requests_total", Type::Counter,
              "Requests answered, by method, route and status."},
    FamilyRow{Metric::request_seconds, "unwrapd_request_seconds", Type::Histogram,
              "From the end of a request's head to the last byte of its answer."},
    FamilyRow{Metric::received_bytes, "unwrapd_received_bytes_total", Type::Counter,
              "Bytes of request bodies, without their framing."},
    FamilyRow{Metric::sent_bytes, "unwrapd_sent_bytes_total", Type::Counter, "Bytes of answers."},
    FamilyRow{Metric::sources, "unwrapd_sources_total", Type::Counter,
              "Meshes asked for at an address (source), by outcome: read, or the problem's code."},
    FamilyRow{Metric::source_bytes, "unwrapd_source_bytes_total", Type::Counter,
              "Bytes of meshes that were read from an address."},
    FamilyRow{Metric::errors, "unwrapd_errors_total", Type::Counter,
              "Problems in answers to requests, by code."},
    FamilyRow{Metric::connections, "unwrapd_connections", Type::Gauge,
              "Open connections: parked (no complete request yet) or served."},
    FamilyRow{Metric::jobs, "unwrapd_jobs", Type::Gauge,
              "Jobs that are queued or running, on all nodes."},
    FamilyRow{Metric::waiting_seconds, "unwrapd_waiting_seconds", Type::Gauge,
              "How long the job has waited that waits longest; 0 while none waits."},
    FamilyRow{Metric::jobs_ended, "unwrapd_jobs_ended_total", Type::Counter,
              "Jobs that ended, by state."},
    FamilyRow{Metric::job_errors, "unwrapd_job_errors_total", Type::Counter,
              "Problems of failed jobs, by code."},
    FamilyRow{Metric::jobs_forced, "unwrapd_jobs_forced_total", Type::Counter,
              "Jobs that did not stop within --grace-seconds, by how they were ended: killed "
              "(their process) or given_up (their thread)."},
    FamilyRow{Metric::lost_threads, "unwrapd_lost_threads", Type::Gauge,
              "Threads that still work on jobs that were given up."},
    FamilyRow{Metric::job_cpu_seconds, "unwrapd_job_cpu_seconds_total", Type::Counter,
              "User and system CPU time of processes of jobs that have ended, in seconds."},
    FamilyRow{Metric::shared_bundles, "unwrapd_shared_bundles_total", Type::Counter,
              "Bundles of jobs whose work several workers share, by outcome: offered (by a job of "
              "this node), helped (made here for another job), found (made by a helper) or lost "
              "(waited for in vain, and made again)."},
    FamilyRow{Metric::isolation, "unwrapd_isolation", Type::Gauge,
              "1 when each job runs in its own process, else 0."},
    FamilyRow{Metric::stage_seconds, "unwrapd_job_stage_seconds", Type::Histogram,
              "Time of each stage of jobs; the first is queue."},
    FamilyRow{Metric::iterations, "unwrapd_iterations_total", Type::Counter,
              "Iterations of the solvers."},
    FamilyRow{Metric::event_streams, "unwrapd_event_streams", Type::Gauge, "Event streams open."},
    FamilyRow{Metric::cache_requests, "unwrapd_cache_requests_total", Type::Counter,
              "Requests to a cache, by cache and outcome (hit, miss)."},
    FamilyRow{Metric::cache_bytes, "unwrapd_cache_bytes", Type::Gauge,
              "Memory that a cache holds, by cache."},
    FamilyRow{Metric::made_bytes, "unwrapd_cache_made_bytes_total", Type::Counter,
              "Bytes of files made because of cache misses, by cache."},
    FamilyRow{Metric::stored_bytes, "unwrapd_stored_bytes", Type::Gauge,
              "Bytes of the files of jobs, meshes and uploads."},
    FamilyRow{Metric::free_bytes, "unwrapd_free_bytes", Type::Gauge,
              "Bytes that are free on the file system of the jobs' files."},
    FamilyRow{Metric::webhooks_due, "unwrapd_webhooks_due", Type::Gauge,
              "Calls of webhooks whose time has come, and that were not answered yet."},
    FamilyRow{Metric::resident_bytes, "process_resident_memory_bytes", Type::Gauge,
              "Resident memory size in bytes."},
    FamilyRow{Metric::cpu_seconds, "process_cpu_seconds_total", Type::Counter,
              "Total user and system CPU time spent in seconds."},
    FamilyRow{Metric::open_files, "process_open_fds", Type::Gauge, "Open file descriptors."},
    FamilyRow{Metric::start_time, "process_start_time_seconds", Type::Gauge,
              "Start time of the process since the Unix epoch in seconds."},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kFamilies.size(); ++i)
    if (kFamilies[i].metric != static_cast<Metric>(i)) return false;
  return kFamilies.size() == kMetricCount;
}
static_assert(in_order(), "a family for every Metric, in the order of the enum");

std::size_t index(Metric metric) { return static_cast<std::size_t>(metric); }

prometheus::Labels owned(const Labels& labels) { return {labels.begin(), labels.end()}; }

template <typename T>
prometheus::Family<T>& add(prometheus::detail::Builder<T> builder, const FamilyRow& row,
                           prometheus::Registry& registry) {
  return builder.Name(row.name).Help(row.help).Register(registry);
}

/// The series of a value that is asked for.
prometheus::ClientMetric series(Type type, const prometheus::Labels& labels, double value) {
  prometheus::ClientMetric series;
  for (const auto& [name, text] : labels) series.label.push_back({name, text});
  (type == Type::Counter ? series.counter.value : series.gauge.value) = value;
  return series;
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0;
  double resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// who: of this process, or of its children that have ended.
double cpu_seconds(decltype(RUSAGE_SELF) who) {
  rusage usage{};
  ::getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double open_files() {
  std::error_code error;
  const std::filesystem::directory_iterator files("/proc/self/fd", error);
  return static_cast<double>(std::distance(begin(files), end(files)));
}

}  // namespace

Metrics::Metrics() {
  for (const FamilyRow& row : kFamilies) {
    Family& family = families_[index(row.metric)];
    if (row.type == Type::Counter)
      family = &add(prometheus::BuildCounter(), row, registry_);
    else if (row.type == Type::Gauge)
      family = &add(prometheus::BuildGauge(), row, registry_);
    else
      family = &add(prometheus::BuildHistogram(), row, registry_);
  }
  // Told from the start, so that their rates are known from the start.
  for (const Metric metric : {Metric::iterations, Metric::received_bytes, Metric::sent_bytes})
    count(metric, {}, 0);
  for (const std::string_view how : {"killed", "given_up"})
    count(Metric::jobs_forced, {{"ended", how}}, 0);
}

void Metrics::count(Metric metric, const Labels& labels, double by) {
  const Family& family = families_[index(metric)];
  if (const auto* counters = std::get_if<prometheus::Family<prometheus::Counter>*>(&family))
    (*counters)->Add(owned(labels)).Increment(by);
  else
    std::get<prometheus::Family<prometheus::Gauge>*>(family)->Add(owned(labels)).Increment(by);
}

void Metrics::observe(Metric metric, const Labels& labels, double value) {
  static const prometheus::Histogram::BucketBoundaries bounds = {0.005, 0.025, 0.1,  0.5,   1.0,
                                                                 5.0,   15.0,  60.0, 300.0, 900.0};
  std::get<prometheus::Family<prometheus::Histogram>*>(families_[index(metric)])
      ->Add(owned(labels), bounds)
      .Observe(value);
}

void Metrics::tell(Metric metric, const Labels& labels, Ask ask) {
  const std::lock_guard lock(mutex_);
  asked_[metric][owned(labels)] = std::move(ask);
}

std::vector<MetricFamily> Metrics::collect() const {
  std::vector<MetricFamily> families = registry_.Collect();
  const auto asked = [this] {
    const std::lock_guard lock(mutex_);
    return asked_;
  }();
  for (const auto& [metric, asks] : asked) {
    const FamilyRow& row = kFamilies[index(metric)];
    MetricFamily& family = families.emplace_back();
    family.name = row.name, family.help = row.help, family.type = row.type;
    for (const auto& [labels, ask] : asks) family.metric.push_back(series(row.type, labels, ask()));
  }
  return families;
}

std::string Metrics::text() const { return prometheus::TextSerializer().Serialize(collect()); }

void tell_process(Metrics& metrics) {
  const auto start = static_cast<double>(now_ms()) / 1000;
  metrics.tell(Metric::build_info, {{"version", UNWRAPD_VERSION}}, [] { return 1; });
  metrics.tell(Metric::resident_bytes, {}, resident_bytes);
  metrics.tell(Metric::cpu_seconds, {}, [] { return cpu_seconds(RUSAGE_SELF); });
  metrics.tell(Metric::job_cpu_seconds, {}, [] { return cpu_seconds(RUSAGE_CHILDREN); });
  metrics.tell(Metric::open_files, {}, open_files);
  metrics.tell(Metric::start_time, {}, [start] { return start; });
}

}  // namespace unwrapd::server
