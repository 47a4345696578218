#pragma once
// A job's output in the server itself: events go to its feed, files to its folder.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/jobs/job_queue.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/quota_reservations.hpp"
#include "server/work/job_output.hpp"

namespace unwrapd::server::jobs {

/// The room of a job's results in its owner's quota.
struct ResultClaim {
  store::QuotaReservation& reservation;
  /// Bytes that an owner may have; 0: any.
  const std::function<std::int64_t(const std::string& owner)>& most_bytes;
};

/// Of a job that has ended meanwhile nothing is put out any more: files throw Error{cancelled}.
class FeedOutput final : public work::JobOutput {
 public:
  /// What an attempt before has claimed is given up: its files are replaced.
  FeedOutput(const RunningJob& job, store::BlobStore& blobs, ResultClaim room);

  /// Told as an event where a stage or a chart begins, and when the job has moved on by half a
  /// percent: what watches progress would read thousands of them otherwise.
  void stage(const StageEvent& event) override;
  void iteration(const IterationEvent& event, double elapsed_ms) override;
  void result(std::string_view format, std::string_view bytes) override;
  void file(std::string_view name, std::string_view bytes) override;

 private:
  void keep(std::string_view name, std::string_view bytes);

  const RunningJob& job_;
  store::BlobStore& blobs_;
  const ResultClaim room_;
  std::optional<StageEvent> told_;  // last, as an event
};

}  // namespace unwrapd::server::jobs
