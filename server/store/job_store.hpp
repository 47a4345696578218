#pragma once
// The jobs table: every change of a job's state is one transaction here, guarded by the state it
// must come from, so that two threads (or a late worker) can never both win.
//
// A running job has the name of its node and a beat, which rises while that node works on it. Nodes
// watch the beats of others by their own clocks (lease_watch.hpp). Whose turn it is follows from
// the table `shares`, which triggers keep: of the owners with waiting jobs, the one that has been
// served least so far comes next. Service is the time of ended jobs, and for each running job the
// mean length of jobs. An owner that comes back after a pause starts level with the least served of
// the others (start-time fair queueing: Goyal, Vin, Cheng, SIGCOMM 1996, with jobs for packets).
// Rejected: one queue in order of arrival, in which a thousand jobs of one key make all others
// wait.

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/retention_clock.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/database/database_address.hpp"
#include "server/store/job_record.hpp"
#include "server/store/stage_of_job.hpp"

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
  std::int64_t ran_ms = 0;        ///< how long the attempt took that ends
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

/// What an owner may have; 0: no limit.
struct OwnerLimits {
  std::int64_t live_jobs = 0;
  std::int64_t stored_bytes = 0;
};

/// How an insertion comes out.
struct Insertion {
  enum class Outcome {
    added,
    known,         ///< a job of this id, or of this request of its owner, is there already
    ticket_spent,  ///< by another job
    too_many_jobs,
    too_many_bytes
  };
  Outcome outcome = Outcome::added;
  std::int64_t seq = 0;  ///< of the job that was added
};

/// The jobs that wait or run, and for whom.
struct QueueCounts {
  std::int64_t waiting = 0;
  std::int64_t running = 0;
  std::int64_t owners = 0;  ///< with jobs that wait or run
};

inline constexpr std::int64_t kNodeSeenMs = 60'000;  ///< after which a node counts as gone

/// A server that works on the store.
struct Node {
  std::string id;          ///< lasting
  bool is_shared = false;  ///< other nodes work on the same store
  /// It has others beside it, and keeps its work on meshes for further jobs.
  bool keeps_work = false;
};

/// A queued job: whether this node, or another one that is there, has lately worked on its
/// document.
struct WaitingJob {
  std::int64_t seq = 0;
  bool is_known_here = false, is_known_elsewhere = false;
};

/// Thread-safe. Every function may throw Error{storage_failed, storage_full}.
class JobStore {
 public:
  /// Throws when it cannot be written. read: the clocks.
  explicit JobStore(const database::DatabaseAddress& address,
                    RetentionClock::Read read = read_clocks, Node node = {});

  /// Called with each job that is found or taken from now on. Where another node has ended it, its
  /// results may not be in their place yet.
  void on_found(std::function<void(const JobRecord& job)> action) { on_found_ = std::move(action); }

  [[nodiscard]] const Node& node() const { return node_; }
  [[nodiscard]] Moment now() const { return time_->now(); }
  /// By how much the time of day was set since the last call, or the last one of the server before;
  /// 0 when it was not. What the clocks show is noted for the next start, where no other node has
  /// clocks, too.
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

  /// Adds a queued job, which spends the ticket that it comes with; or nothing. Exact, whatever
  /// other nodes insert meanwhile.
  Insertion insert(const JobRecord& job, const OwnerLimits& limits = {},
                   const std::optional<SpentTicket>& ticket = {}, std::int64_t now_ms = 0);
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
  /// Bytes of all jobs and stored meshes.
  std::int64_t stored_bytes();
  /// Bytes of finished jobs, and of stored meshes that no other job is about.
  std::int64_t evictable_bytes();

  QueueCounts counts();
  /// When the job that has waited longest came; nothing while none waits.
  std::optional<std::int64_t> first_waiting_ms();
  /// The owner whose turn it is, if jobs wait. mean_ms: the usual length of jobs.
  std::optional<std::string> next_owner(std::int64_t mean_ms);
  /// Forgets what owners without jobs were served, where it says nothing more.
  void level_shares();
  /// Seconds of the jobs that ended last, so many at most, the newest first.
  std::vector<double> last_lengths(int count);
  /// The most urgent, and of those the oldest, queued job of this owner, now running on this node,
  /// its attempt counted. Nothing where there is none, or another node is taking it.
  std::optional<JobRecord> take(std::string_view owner, std::int64_t now_ms = 0);
  /// The first of the jobs that take() would return, so many at most, in its order. Of nodes that
  /// keep their work, as the next three.
  std::vector<WaitingJob> first_waiting(std::string_view owner, int most);
  /// take() of this job.
  std::optional<JobRecord> take_one(std::int64_t seq, std::int64_t now_ms);
  /// Forgets what this node has worked on, as it has, or what any has that is long ago.
  void forget_own_work();
  void forget_old_work();
  /// Notes a stage that has so many bundles; true for the first process of this attempt to do so.
  bool open_stage(const StageOfJob& of, int bundles);
  /// The next bundle that no process has begun: for the job's own from the front, for a helper from
  /// the back. None where all were begun.
  std::optional<int> claim_bundle(const StageOfJob& of, bool is_helper);
  /// Keeps a bundle for the other processes, as long as its stage is known.
  void keep_bundle(const StageOfJob& of, int bundle, std::string_view bytes);
  std::optional<std::string> bundle(const StageOfJob& of, int bundle);
  /// Whether this attempt of a job still runs.
  bool is_running(std::int64_t job, int attempt);
  /// A running job with bundles that nobody has begun, of the owner who was served least.
  /// passed_over: jobs (their seq) that are not asked for.
  std::optional<JobRecord> job_to_help(const std::vector<std::int64_t>& passed_over);
  /// Notes that a process has helped with a job of this owner for so long.
  void charge(std::string_view owner, std::int64_t ms);
  /// Drops what processes have exchanged for this job, or for all that have ended.
  void drop_shared_work(std::int64_t job);
  void drop_ended_shared_work();
  /// Raises the beat of an attempt of this node. False when it is no longer that: another node has
  /// taken it up.
  bool beat(const JobRecord& job);
  /// Running jobs; on_others: only those of other nodes.
  std::vector<JobRecord> running(bool on_others = false);
  /// Ids of this node's running jobs that somebody has cancelled.
  std::vector<std::string> cancelled_here();
  /// Says that this node is there, with so many workers, and returns those of all that have said so
  /// lately.
  std::int64_t announce(std::int64_t workers);
  /// Ends a job and queues the call to its webhook. False, and nothing is changed, when it is no
  /// longer in the state and attempt that the caller knows it in.
  bool finish(const JobRecord& known, const JobOutcome& outcome);
  /// Ends a job whose row cannot be read, so that it can be, and queues the call to its webhook.
  void set_aside(const JobRecord& unreadable, const JobOutcome& outcome);
  /// Remembers that a running job shall end, even over a crash.
  void request_cancel(std::string_view id);
  /// Remembers that a running job has ended a process of its own.
  void note_process_end(std::string_view id);
  /// A running job waits again; crashed: because its server died, or could not stop it. ran_ms: how
  /// long this attempt took. False, and nothing is changed, when the attempt that the caller knows
  /// no longer runs, or has shown a sign of life meanwhile.
  bool requeue(const JobRecord& known, bool crashed, std::int64_t ran_ms = 0);

  /// The files of a job are kept while it is not final, or has succeeded and not expired. Their
  /// fate is `unknown` when the job has no row, or one that cannot be read.
  blobs::FolderFate fate_of(std::string_view id);
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
    change([&] { database::Statement(*database_, sql).with(values...).run(); });
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

  bool spend(const SpentTicket& ticket, std::int64_t now_ms);
  std::int64_t insert_row(const JobRecord& job);
  void check_limits(const JobRecord& job, const OwnerLimits& limits);
  void mend_sums();
  void mend_shares();
  void queue_delivery(const JobRecord& job, const JobOutcome& outcome);

  const Node node_;
  std::function<void(const JobRecord& job)> on_found_;
  std::mutex mutex_;
  const std::shared_ptr<database::Database> database_;
  NotedTime noted_;
  std::optional<const RetentionClock> time_;
  std::atomic<bool> write_failed_ = true;  // or was not tried
};

}  // namespace unwrapd::server::store
