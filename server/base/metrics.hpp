#pragma once
// The metrics of the server, written in the text format of Prometheus (exposition format 0.0.4) by
// prometheus-cpp. metrics.cpp has the table of all families.

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace unwrapd::server {

enum class Metric {
  build_info,
  requests,
  request_seconds,
  received_bytes,
  sent_bytes,
  sources,
  source_bytes,
  errors,
  connections,
  jobs,
  waiting_seconds,
  jobs_ended,
  job_errors,
  jobs_forced,
  lost_threads,
  job_cpu_seconds,
  shared_bundles,
  isolation,
  stage_seconds,
  iterations,
  event_streams,
  cache_requests,
  cache_bytes,
  made_bytes,
  stored_bytes,
  free_bytes,
  webhooks_due,
  resident_bytes,
  cpu_seconds,
  open_files,
  start_time,
};
inline constexpr std::size_t kMetricCount = static_cast<std::size_t>(Metric::start_time) + 1;

using Labels = std::vector<std::pair<std::string_view, std::string_view>>;

/// Thread-safe.
class Metrics {
 public:
  using Ask = std::function<double()>;

  Metrics();

  /// Adds to a counter, or to a gauge.
  void count(Metric metric, const Labels& labels = {}, double by = 1);
  /// Puts a value into a histogram.
  void observe(Metric metric, const Labels& labels, double value);
  /// A value that is asked for whenever the metrics are written; ask must stay callable. A metric
  /// is either counted or asked for.
  void tell(Metric metric, const Labels& labels, Ask ask);

  /// Ends with a line feed. Each series is of one moment; two series may be of different moments.
  [[nodiscard]] std::string text() const;

  static constexpr std::string_view kContentType = "text/plain; version=0.0.4; charset=utf-8";

 private:
  using Family =
      std::variant<prometheus::Family<prometheus::Counter>*, prometheus::Family<prometheus::Gauge>*,
                   prometheus::Family<prometheus::Histogram>*>;

  [[nodiscard]] std::vector<prometheus::MetricFamily> collect() const;

  prometheus::Registry registry_;
  std::array<Family, kMetricCount> families_;  // the registry's
  mutable std::mutex mutex_;
  std::map<Metric, std::map<prometheus::Labels, Ask>> asked_;
};

/// Adds memory, processor time, open files and start time of this process.
void tell_process(Metrics& metrics);

/// Counters of a store of files that are made on request, since the start. Thread-safe.
struct FileCounts {
  std::atomic<std::uint64_t> hits = 0;    ///< the file was there
  std::atomic<std::uint64_t> misses = 0;  ///< it was made
  std::atomic<std::uint64_t> bytes = 0;   ///< of those that were made

  void made(std::string_view file) {
    ++misses;
    bytes += file.size();
  }
};

}  // namespace unwrapd::server
