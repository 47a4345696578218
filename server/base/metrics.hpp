#pragma once
// What the server counts of itself, told in the text format of Prometheus (exposition format
// 0.0.4). The families are one table (metrics.cpp); a value has a place in it or does not exist.
//
// Rejected: prometheus-cpp, whose families are found by name at run time and whose counters cannot
// be read back; two hundred lines of our own need no further library in the image.

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace unwrapd::server {

enum class Metric {
  build_info,
  requests,
  request_seconds,
  received_bytes,
  sent_bytes,
  errors,
  connections,
  jobs,
  jobs_ended,
  job_errors,
  jobs_forced,
  lost_threads,
  isolation,
  stage_seconds,
  iterations,
  event_streams,
  cache_requests,
  cache_bytes,
  made_bytes,
  stored_bytes,
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

  /// Adds to a counter.
  void count(Metric metric, const Labels& labels = {}, double by = 1);
  /// Puts a value into a histogram.
  void observe(Metric metric, const Labels& labels, double value);
  /// A value that is asked for whenever the metrics are told; ask must be callable as long as that.
  void tell(Metric metric, const Labels& labels, Ask ask);

  /// Ends with a line feed. What it tells is of one moment for each family only.
  [[nodiscard]] std::string text() const;

  static constexpr std::string_view kContentType = "text/plain; version=0.0.4; charset=utf-8";

 private:
  static constexpr std::array kBounds = {0.005, 0.025, 0.1,  0.5,   1.0,
                                         5.0,   15.0,  60.0, 300.0, 900.0};
  struct Series {
    double sum = 0;                                           ///< of a counter: its value
    std::array<std::uint64_t, kBounds.size() + 1> buckets{};  ///< not cumulative
    Ask ask;
  };
  using Family = std::map<std::string, Series>;  // by its labels as they are written

  static std::string histogram_text(std::string_view name, const std::string& labels,
                                    const Series& series);

  mutable std::mutex mutex_;
  std::array<Family, kMetricCount> families_;
};

/// Adds what the kernel knows of this process.
void tell_process(Metrics& metrics);

}  // namespace unwrapd::server
