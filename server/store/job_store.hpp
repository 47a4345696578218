#pragma once
// The jobs table: every change of a job's state is one transaction here, guarded by the state it
// must come from, so that two threads (or a late worker) can never both win.
//
// A running job is on lease to this process, on the clock of elapsed time: setting the time of day
// neither ends a lease nor prolongs it.

#include <atomic>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/retention_clock.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/database_address.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::store {

/// How a job ends.
// NOLINTNEXTLINE(bugprone-exception-escape): moving a JSON value moves a pointer, and cannot throw
struct JobOutcome {
  api::JobState state = api::JobState::succeeded;
  std::string result_format;
  api::Json problem;
  std::int64_t last_event = 0;
  std::int64_t finished_ms = 0;
  std::int64_t set_by_ms = 0;     ///< Moment::set_by_ms at that time
  std::int64_t stored_bytes = 0;  ///< of the job's files, 0 when none are left
  std::string delivery = {};      ///< body of the call to the job's webhook, where it has one
};

/// Of a job that ends without a result.
JobOutcome ended(api::JobState state, const Error& why, std::string_view job);

/// Which jobs are listed: the newest first.
struct JobFilter {
  std::optional<std::string> owner;      ///< of one owner only
  std::optional<api::JobState> state;    ///< in one state only
  std::optional<std::string> name = {};  ///< of this name only
  std::int64_t before_seq = 0;  ///< only those that came before this one; 0: from the newest
  int limit = 50;
};

/// An upload ticket that a job has come with.
struct SpentTicket {
  std::string id;
  std::int64_t until_ms = 0;  ///< when it expires
};

/// What an owner has here.
struct OwnerUsage {
  std::int64_t live_jobs = 0;  ///< queued or running
  std::int64_t stored_bytes = 0;
};

/// Thread-safe. Every function may throw Error{storage_failed, storage_full}.
class JobStore {
 public:
  /// Throws when it cannot be written. read: the clocks.
  explicit JobStore(const DatabaseAddress& address, RetentionClock::Read read = read_clocks);

  [[nodiscard]] Moment now() const { return time_->now(); }
  /// By how much the time of day was set since the last call, or the last one of the server before;
  /// 0 when it was not. What the clocks show is noted for the next start.
  std::int64_t note_time();

  /// Writes to it when the last write has failed, or none was tried; does not throw storage_full.
  /// Throws where it was found damaged since the start, or cannot be reached.
  void check_writable();
  /// Whether it could not be reached since this was asked last, so that changes failed or are in
  /// doubt.
  [[nodiscard]] bool was_away() {
    const std::lock_guard lock(mutex_);
    return database_->was_away();
  }

  /// Adds a queued job and returns its seq.
  std::int64_t insert(const JobRecord& job);
  /// The same of a job that comes with a ticket, which it spends; nothing, and nothing is added,
  /// where that was spent before.
  std::optional<std::int64_t> insert(const JobRecord& job, const SpentTicket& ticket,
                                     std::int64_t now_ms);
  /// Whether a job has come with this ticket, be it here or removed meanwhile.
  bool is_spent(std::string_view ticket);
  [[nodiscard]] std::optional<JobRecord> find(std::string_view id);
  /// The job that an owner's request of this name has made.
  std::optional<JobRecord> find_request(std::string_view owner, std::string_view request_key);
  /// A succeeded job of this owner that was asked the same and still has its files.
  std::optional<JobRecord> find_same(std::string_view owner, std::string_view content_key);
  /// All jobs that have not ended, the oldest first; with those whose state cannot be read.
  std::vector<JobRecord> unfinished();
  std::vector<JobRecord> list(const JobFilter& filter);
  OwnerUsage usage(std::string_view owner);
  /// Rows of all jobs.
  std::int64_t job_count();
  /// The job to give up where there are too many: the expired one that ended first, or of the owner
  /// with the most jobs the ended one that came first.
  std::optional<std::string> first_to_go();
  /// Bytes of finished jobs, and of stored meshes that no other job is about.
  std::int64_t evictable_bytes();

  /// The most urgent, and of those the oldest, queued job of this owner, now running and on lease
  /// until then, its attempt counted.
  std::optional<JobRecord> take(std::string_view owner, std::int64_t lease_ms);
  void renew(std::string_view id, std::int64_t lease_ms);
  /// Running jobs whose lease has ended by now.
  std::vector<JobRecord> lapsed(std::int64_t now_ms);
  /// Ends a job and queues the call to its webhook. False, and nothing is changed, when it is no
  /// longer in the state and attempt that the caller knows it in.
  bool finish(const JobRecord& known, const JobOutcome& outcome);
  /// Ends a job whose row cannot be read, so that it can be, and queues the call to its webhook.
  void set_aside(const JobRecord& unreadable, const JobOutcome& outcome);
  /// Remembers that a running job shall end, even over a crash.
  void request_cancel(std::string_view id);
  /// Remembers that a running job has ended a process of its own.
  void note_process_end(std::string_view id);
  /// A running job waits again; crashed: because the server died, or could not stop it.
  void requeue(std::string_view id, bool crashed);

  /// The files of a job are kept while it is not final, or has succeeded and not expired. Their
  /// fate is `unknown` when the job has no row, or one that cannot be read.
  FolderFate fate_of(std::string_view id);
  /// Final jobs that ended before this time (of Moment::kept_ms(), like all below) and still have
  /// their files, the oldest first.
  std::vector<std::string> finished_before(std::int64_t epoch_ms,
                                           int limit = std::numeric_limits<int>::max());
  void set_stored_bytes(std::string_view id, std::int64_t bytes);
  /// The same of many succeeded jobs, in one transaction; what is right stays as it is. Does not
  /// throw storage_full.
  void mend_stored_bytes(const std::vector<std::pair<std::string, std::int64_t>>& jobs);
  void set_expired(std::string_view id);
  /// Removes the rows of expired jobs that ended before this time.
  void forget_before(std::int64_t epoch_ms);
  void remove(std::string_view id);

 private:
  /// The store while it is written: it remembers whether that came about.
  class Writing {
   public:
    explicit Writing(JobStore& store)
        : store_(store), lock_(store.mutex_), errors_(std::uncaught_exceptions()) {}
    Writing(const Writing&) = delete;
    Writing& operator=(const Writing&) = delete;
    ~Writing() { store_.write_failed_ = std::uncaught_exceptions() > errors_; }

   private:
    JobStore& store_;
    const std::lock_guard<std::mutex> lock_;
    const int errors_;
  };

  /// The first row of `SELECT ... WHERE`, with these values bound.
  template <class... Values>
  std::optional<JobRecord> first(std::string_view rest, const Values&... values);

  /// A change by one statement whose rows nobody asks for.
  template <class... Values>
  void update(std::string_view sql, const Values&... values) {
    change([&] { Statement(*database_, sql).with(values...).run(); });
  }
  /// Database::change() and transact() of this store, which remembers whether that came about.
  template <class Make>
  auto change(const Make& make) {
    const Writing writing(*this);
    return database_->change(make);
  }
  template <class Make>
  auto transact(const Make& make) {
    const Writing writing(*this);
    return database_->transact(make);
  }

  std::int64_t insert_row(const JobRecord& job);
  void mend_sums();
  void queue_delivery(const JobRecord& job, const JobOutcome& outcome);

  std::mutex mutex_;
  const std::unique_ptr<Database> database_;
  NotedTime noted_;
  std::optional<const RetentionClock> time_;
  std::atomic<bool> write_failed_ = true;  // or was not tried
};

}  // namespace unwrapd::server::store
