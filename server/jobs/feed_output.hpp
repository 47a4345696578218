#pragma once
// The output of a job in the server itself: events go to its feed, files to its folder.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/blobs/blob_store.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/quota_reservations.hpp"
#include "server/work/run_job.hpp"

namespace unwrapd::server::jobs {

/// The share of a job's results in the quota of its owner.
struct ResultClaim {
  store::QuotaReservation& reservation;
  /// Bytes that an owner may store; 0: any.
  const std::function<std::int64_t(const std::string& owner)>& most_bytes;
};

/// Files of a job that has ended meanwhile throw Error{cancelled}; its events are dropped. Files
/// wait for a store that cannot be reached, until the job is stopped.
class FeedOutput final : public work::JobOutput {
 public:
  /// Gives up what an earlier attempt has reserved, as its files are replaced.
  FeedOutput(const RunningJob& job, blobs::BlobStore& blobs, ResultClaim room);

  /// Publishes an event when a stage or a chart begins, and for each half percent of progress:
  /// readers would get thousands of events otherwise.
  void stage(const StageEvent& event) override;
  void iteration(const IterationEvent& event, double elapsed_ms) override;
  void note(const Note& note) override;
  void result(std::string_view format, std::string_view bytes) override;
  void file(std::string_view name, std::string_view bytes) override;

 private:
  void keep(std::string_view name, std::string_view bytes);
  [[nodiscard]] bool try_keep(std::string_view name, std::string_view bytes);

  const RunningJob& job_;
  blobs::BlobStore& blobs_;
  const ResultClaim room_;
  std::optional<StageEvent> told_;  // last, as an event
};

}  // namespace unwrapd::server::jobs
