#pragma once
// A job's output in the server itself: events go to its feed, files to its folder.

#include <optional>

#include "server/blob_store.hpp"
#include "server/job_output.hpp"
#include "server/job_queue.hpp"

namespace unwrapd::server {

class FeedOutput final : public JobOutput {
 public:
  FeedOutput(const RunningJob& job, BlobStore& blobs) : job_(job), blobs_(blobs) {}

  /// Told as an event where a stage or a chart begins, and when the job has moved on by half a
  /// percent: what watches progress would read thousands of them otherwise.
  void stage(const StageEvent& event) override;
  void iteration(const IterationEvent& event, double elapsed_ms) override;
  void result(std::string_view format, std::string_view bytes) override;
  void file(std::string_view name, std::string_view bytes) override;

 private:
  const RunningJob& job_;
  BlobStore& blobs_;
  std::optional<StageEvent> told_;  // last, as an event
};

}  // namespace unwrapd::server
