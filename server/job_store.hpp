#pragma once
// The jobs table: every change of a job's state is one transaction here, guarded by the state it
// must come from, so that two threads (or a late worker) can never both win. SQLite was chosen over
// files per job for these transactions, over a server process for being embedded.

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/database.hpp"
#include "server/job_record.hpp"

namespace unwrapd::server {

/// How a job ends.
// NOLINTNEXTLINE(bugprone-exception-escape): moving a JSON value moves a pointer, and cannot throw
struct JobOutcome {
  api::JobState state = api::JobState::succeeded;
  std::string result_format;
  api::Json problem;
  std::int64_t last_event = 0;
  std::int64_t finished_ms = 0;
};

/// Thread-safe. Every function may throw Error{storage_failed}.
class JobStore {
 public:
  explicit JobStore(const std::filesystem::path& path);

  /// Adds a queued job and returns its seq.
  std::int64_t insert(const JobRecord& job);
  [[nodiscard]] std::optional<JobRecord> find(std::string_view id);
  /// All jobs in this state, the oldest first.
  std::vector<JobRecord> all(api::JobState state);

  /// The oldest queued job, now running, its attempt counted.
  std::optional<JobRecord> take_oldest();
  /// Ends a job. False, and nothing is changed, when it is no longer in the state and attempt that
  /// the caller knows it in.
  bool finish(const JobRecord& known, const JobOutcome& outcome);
  /// Remembers that a running job shall end, even over a crash.
  void request_cancel(std::string_view id);
  /// A running job waits again; crashed: because the server died.
  void requeue(std::string_view id, bool crashed);

  /// Final jobs that ended before this time and still have their files.
  std::vector<std::string> finished_before(std::int64_t epoch_ms);
  void set_expired(std::string_view id);
  /// Removes the rows of expired jobs that ended before this time.
  void forget_before(std::int64_t epoch_ms);
  void remove(std::string_view id);

 private:
  std::vector<JobRecord> rows(Statement& statement);
  void migrate();

  std::mutex mutex_;
  Database database_;
};

}  // namespace unwrapd::server
