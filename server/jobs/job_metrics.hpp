#pragma once
// Counts jobs by their events: how long each waited and each stage took, iterations, and how each
// ended. All ways of running a job, in this process or another, publish these events; those of
// other nodes are counted there.

#include <chrono>
#include <string>

#include "api/events.hpp"
#include "server/base/metrics.hpp"

namespace unwrapd::server::jobs {

class JobMetrics {
 public:
  /// waited: how long the job has waited before.
  JobMetrics(Metrics& metrics, std::chrono::milliseconds waited)
      : metrics_(metrics), since_(std::chrono::steady_clock::now() - waited) {}

  /// Counts the next event of the job.
  void see(const api::Event& event);

 private:
  void enter(const std::string& stage);

  Metrics& metrics_;
  std::string stage_ = "queue";
  std::chrono::steady_clock::time_point since_;
};

}  // namespace unwrapd::server::jobs
