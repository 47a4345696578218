#pragma once
// Counts what the events of a job tell: whether it waits or runs, how long it waited and each stage
// took, iterations, and how it ended. Events are where every way of running a job meets, in this
// process or another.

#include <chrono>
#include <string>

#include "api/events.hpp"
#include "server/base/metrics.hpp"

namespace unwrapd::server::jobs {

class JobMetrics {
 public:
  explicit JobMetrics(Metrics& metrics);
  JobMetrics(const JobMetrics&) = delete;
  JobMetrics& operator=(const JobMetrics&) = delete;
  ~JobMetrics();

  /// The next event of the job, as it is published.
  void see(const api::Event& event);

 private:
  void enter(const std::string& stage);
  void become(std::string_view state);

  Metrics& metrics_;
  std::string_view state_;  // empty: neither queued nor running
  std::string stage_ = "queue";
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
};

}  // namespace unwrapd::server::jobs
