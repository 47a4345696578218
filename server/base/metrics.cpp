#include "server/base/metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "server/base/clock.hpp"

namespace unwrapd::server {
namespace {

struct FamilyRow {
  Metric metric;
  std::string_view name;
  std::string_view type;
  std::string_view help;
};

constexpr std::array kFamilies = {
    FamilyRow{Metric::build_info, "unwrapd_build_info", "gauge", "1, with the version as a label."},
    FamilyRow{Metric::requests, "unwrapd_requests_total", "counter",
              "Requests answered, by method, route and status."},
    FamilyRow{Metric::request_seconds, "unwrapd_request_seconds", "histogram",
              "From the end of a request's head to the last byte of its answer."},
    FamilyRow{Metric::received_bytes, "unwrapd_received_bytes_total", "counter",
              "Bytes of request bodies, without their framing."},
    FamilyRow{Metric::sent_bytes, "unwrapd_sent_bytes_total", "counter", "Bytes of answers."},
    FamilyRow{Metric::errors, "unwrapd_errors_total", "counter",
              "Problems that requests were answered with, by code."},
    FamilyRow{Metric::connections, "unwrapd_connections", "gauge",
              "Open connections: parked (no complete request yet) or served."},
    FamilyRow{Metric::jobs, "unwrapd_jobs", "gauge", "Jobs that are queued or running."},
    FamilyRow{Metric::jobs_ended, "unwrapd_jobs_ended_total", "counter",
              "Jobs that came to an end, by state."},
    FamilyRow{Metric::job_errors, "unwrapd_job_errors_total", "counter",
              "Problems that jobs failed of, by code."},
    FamilyRow{Metric::jobs_forced, "unwrapd_jobs_forced_total", "counter",
              "Jobs beyond their limit that did not stop in their grace, by how they were ended: "
              "killed (their process) or given_up (their thread)."},
    FamilyRow{Metric::lost_threads, "unwrapd_lost_threads", "gauge",
              "Threads still at work on jobs that were given up."},
    FamilyRow{Metric::isolation, "unwrapd_isolation", "gauge",
              "1 when each job has a process of its own, else 0."},
    FamilyRow{Metric::stage_seconds, "unwrapd_job_stage_seconds", "histogram",
              "Time of each stage of jobs; the first is queue."},
    FamilyRow{Metric::iterations, "unwrapd_iterations_total", "counter",
              "Iterations of the solvers."},
    FamilyRow{Metric::event_streams, "unwrapd_event_streams", "gauge", "Event streams open."},
    FamilyRow{Metric::cache_requests, "unwrapd_cache_requests_total", "counter",
              "Questions to a cache, by cache and outcome (hit, miss)."},
    FamilyRow{Metric::cache_bytes, "unwrapd_cache_bytes", "gauge",
              "Memory that a cache holds, by cache."},
    FamilyRow{Metric::made_bytes, "unwrapd_cache_made_bytes_total", "counter",
              "Bytes of files that were made because a cache had none, by cache."},
    FamilyRow{Metric::stored_bytes, "unwrapd_stored_bytes", "gauge",
              "Bytes of all jobs' files on disk."},
    FamilyRow{Metric::resident_bytes, "process_resident_memory_bytes", "gauge",
              "Resident memory size in bytes."},
    FamilyRow{Metric::cpu_seconds, "process_cpu_seconds_total", "counter",
              "Total user and system CPU time spent in seconds."},
    FamilyRow{Metric::open_files, "process_open_fds", "gauge", "Open file descriptors."},
    FamilyRow{Metric::start_time, "process_start_time_seconds", "gauge",
              "Start time of the process since the Unix epoch in seconds."},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kFamilies.size(); ++i)
    if (kFamilies[i].metric != static_cast<Metric>(i)) return false;
  return kFamilies.size() == kMetricCount;
}
static_assert(in_order(), "a family for every Metric, in the order of the enum");

std::size_t index(Metric metric) { return static_cast<std::size_t>(metric); }

std::string number_text(double value) {
  std::array<char, 64> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

/// R"(code="x",route="y")"
std::string labels_text(const Labels& labels) {
  std::string text;
  for (const auto& [name, value] : labels) {
    if (!text.empty()) text += ',';
    text += std::string(name) + "=\"";
    for (const char c : value) {
      if (c == '"' || c == '\\') text += '\\';
      text += c == '\n' ? ' ' : c;
    }
    text += '"';
  }
  return text;
}

std::string line(std::string_view name, const std::string& labels, double value) {
  const std::string braces = labels.empty() ? "" : "{" + labels + "}";
  return std::string(name) + braces + " " + number_text(value) + "\n";
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0;
  double resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

double cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
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
  // Told from the start, so that their rates are known from the start.
  for (const Metric metric : {Metric::iterations, Metric::received_bytes, Metric::sent_bytes})
    count(metric, {}, 0);
  for (const std::string_view how : {"killed", "given_up"})
    count(Metric::jobs_forced, {{"ended", how}}, 0);
}

void Metrics::count(Metric metric, const Labels& labels, double by) {
  const std::string key = labels_text(labels);
  const std::lock_guard lock(mutex_);
  families_[index(metric)][key].sum += by;
}

void Metrics::observe(Metric metric, const Labels& labels, double value) {
  const std::string key = labels_text(labels);
  const auto bucket =
      static_cast<std::size_t>(std::ranges::lower_bound(kBounds, value) - kBounds.begin());
  const std::lock_guard lock(mutex_);
  Series& series = families_[index(metric)][key];
  series.sum += value;
  ++series.buckets[bucket];
}

void Metrics::tell(Metric metric, const Labels& labels, Ask ask) {
  const std::lock_guard lock(mutex_);
  families_[index(metric)][labels_text(labels)].ask = std::move(ask);
}

std::string Metrics::histogram_text(std::string_view name, const std::string& labels,
                                    const Series& series) {
  const std::string bucket_name = std::string(name) + "_bucket";
  const std::string before = labels.empty() ? "le=\"" : labels + ",le=\"";
  std::string text;
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < kBounds.size(); ++i) {
    total += series.buckets[i];
    text += line(bucket_name, before + number_text(kBounds[i]) + "\"", static_cast<double>(total));
  }
  total += series.buckets.back();
  text += line(bucket_name, before + "+Inf\"", static_cast<double>(total));
  text += line(std::string(name) + "_sum", labels, series.sum);
  return text + line(std::string(name) + "_count", labels, static_cast<double>(total));
}

std::string Metrics::text() const {
  std::string text;
  for (const FamilyRow& row : kFamilies) {
    Family family;
    {
      const std::lock_guard lock(mutex_);
      family = families_[index(row.metric)];
    }
    if (family.empty()) continue;
    text += "# HELP " + std::string(row.name) + " " + std::string(row.help) + "\n# TYPE " +
            std::string(row.name) + " " + std::string(row.type) + "\n";
    for (const auto& [labels, series] : family) {
      if (row.type == "histogram")
        text += histogram_text(row.name, labels, series);
      else
        text += line(row.name, labels, series.ask ? series.ask() : series.sum);
    }
  }
  return text;
}

void tell_process(Metrics& metrics) {
  const auto start = static_cast<double>(now_ms()) / 1000;
  metrics.tell(Metric::build_info, {{"version", UNWRAPD_VERSION}}, [] { return 1; });
  metrics.tell(Metric::resident_bytes, {}, resident_bytes);
  metrics.tell(Metric::cpu_seconds, {}, cpu_seconds);
  metrics.tell(Metric::open_files, {}, open_files);
  metrics.tell(Metric::start_time, {}, [start] { return start; });
}

}  // namespace unwrapd::server
