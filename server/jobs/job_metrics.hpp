#pragma once
// Counts jobs by their events: those that wait or run, how long each waited and each stage took,
// iterations, and how each ended. All ways of running a job, in this process or another, publish
// these events.

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

  /// Counts the next event of the job.
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
