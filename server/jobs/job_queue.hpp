#pragma once
// The bounded queue of jobs and their life: queued -> running -> succeeded | failed | cancelled.
// The store knows which jobs wait, whose turn it is and what runs where; this class knows the jobs
// that run here, and adds waiting, stop requests and events. A full queue refuses at once rather
// than let requests pile up.
//
// A running job is on lease, which renew_leases() prolongs. A job whose end could not be stored
// because the disk is full keeps its lease until it expires, and then runs again. Where the store
// cannot be reached, the end waits for it. Where several nodes work on one store, each takes up
// jobs of others whose lease has ended.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/log.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/http/http.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/affinity.hpp"
#include "server/jobs/disk_full_backoff.hpp"
#include "server/jobs/event_feed.hpp"
#include "server/jobs/lease_watch.hpp"
#include "server/jobs/work_sharing.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::jobs {

/// lost: another node has taken the job up.
enum class StopCause { none, cancelled, time_limit, draining, lost };

/// A running job. Its end is stored once, either by its worker or by the thread that gives the
/// worker up.
struct RunningJob {
  store::JobRecord record;
  std::shared_ptr<JobFeed> feed;
  std::int64_t started_ms = 0;
  std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  std::stop_source stop;
  std::atomic<StopCause> cause = StopCause::none;
  mutable std::mutex output;  ///< held while something is put out
  bool has_ended = false;     ///< guarded by output; nothing is put out then

  /// Since it began.
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }
  /// Asks the worker to stop; the first cause counts.
  void request_stop(StopCause why) {
    StopCause none = StopCause::none;
    cause.compare_exchange_strong(none, why);
    stop.request_stop();
  }
  /// True for the first caller, which then stores the end of the job.
  [[nodiscard]] bool take_end() {
    const std::lock_guard lock(output);
    return !std::exchange(has_ended, true);
  }
};

struct QueueConfig {
  int max_queue = 256;
  int workers = 1;              ///< of this node
  std::int64_t max_stored = 0;  ///< ended jobs; 0: no limit
  std::chrono::milliseconds lease = std::chrono::seconds(30);
  std::chrono::milliseconds stop = std::chrono::seconds(10);  ///< for jobs told to stop, at the end
};

/// A job whose upload is complete, and how it is to be taken.
struct Submission {
  store::JobRecord job;
  std::string sender = {};    ///< as check_room() was told
  std::string upload;         ///< the folder of its files, of BlobStore::begin_upload()
  http::Quota quota;          ///< of its owner
  bool bypass_cache = false;  ///< run it even when the same question has been answered
  std::optional<store::SpentTicket> ticket = {};  ///< that it came with
};

/// What a worker does next: a job, or help with one that runs; neither when the queue is closed.
struct Turn {
  std::shared_ptr<RunningJob> job = {};
  std::shared_ptr<HelpedJob> helped = {};
};

/// Thread-safe.
class JobQueue {
 public:
  JobQueue(store::JobStore& store, blobs::BlobStore& blobs, EventFeed& events, const Log& log,
           const QueueConfig& config);

  /// Once, before any worker: what the last process left running waits again; a job whose row
  /// cannot be read is set aside. The death of that process is held against those jobs: they are
  /// given up at the third, where they are tried apart from this process from now on, at the tenth.
  /// Those that find no room on the disk for that wait for a renew_leases() that does.
  void recover(bool tried_apart);

  /// Throws RetryLater{queue_full, draining} when a submission would be refused now, else keeps a
  /// place for it until submit() or give_back(). sender: the same for a request that is sent again
  /// when told so, if possible another for each other request.
  void check_room(const Applicant& sender);
  void give_back(std::string_view sender);
  /// Stores a job; one of the same name that is there already is returned instead. A question that
  /// this owner has had answered is answered from the store. Throws like check_room(), and
  /// idempotency_conflict, too_many_jobs, quota_exceeded, storage_full; invalid_link where its
  /// ticket was spent by a job that is gone.
  store::JobRecord submit(Submission submission);
  /// Waits for the job whose turn it is or, where none waits and the worker may help, for a running
  /// one that it may help with. Empty when the queue is closed. A job whose row cannot be read
  /// never runs.
  Turn take_turn(bool may_help);
  /// Ends a job of take_turn(). Its files are complete when it has succeeded. stored: called when
  /// the store has its end, and before anybody is told of it.
  void finish(const RunningJob& job, store::JobOutcome outcome,
              const std::function<void()>& stored = {});

  /// Remembers, over the end of this server, too, that a job has ended a process of its own.
  void note_process_end(const RunningJob& job);

  /// Where the store could not be reached for a while: does what was not done, takes up what was
  /// done unknown to this queue, and counts anew.
  void mend();

  /// Prolongs the leases of the jobs at work, queues those whose lease has ended, and gives up
  /// ended jobs beyond max_stored.
  void renew_leases();

  /// Cancels a live job (true), or removes a finished one and its files (false). Throws not_found.
  bool cancel_or_remove(const std::string& id);

  /// From now on, other nodes are told when jobs wait, or are cancelled.
  void tell_others(std::function<void()> jobs_wait, std::function<void()> cancelled);
  /// Other nodes may have sent jobs, or given some back.
  void look_for_jobs();
  /// Stops the jobs of this node that were cancelled at another.
  void stop_cancelled();
  /// Tells readers here the end of a job that ended elsewhere.
  void tell_end_elsewhere(const std::string& id);

  /// The jobs that wait or run, on all nodes; as they were last, while the store is away.
  [[nodiscard]] store::QueueCounts counts();

  /// How long the job has waited that waits longest, on any node; 0 where none does. It grows while
  /// the store is away.
  [[nodiscard]] double waiting_seconds();
  /// Of jobs whose work several processes share.
  [[nodiscard]] WorkSharing& sharing() { return sharing_; }
  /// Whether there are other workers, here or elsewhere, that could help.
  [[nodiscard]] bool has_helpers() const {
    const std::lock_guard lock(mutex_);
    return all_workers_ > 1;
  }
  /// Of nodes that keep their work.
  [[nodiscard]] AffinityCounts affinity() const { return affinity_.counts(); }

  /// No new jobs from now on; those waiting stay in the store for the next start.
  void close();
  /// Waits for the running jobs; those that are not done by then go back to the queue. False when
  /// some have not even stopped: then they are suspected of what ends servers, and in the queue,
  /// too, or have ended as cancelled, but their threads do not end.
  bool drain(std::chrono::seconds patience);
  /// Takes all patience from drain().
  void stop_waiting();
  [[nodiscard]] bool draining() const { return closed_; }
  /// The answer while jobs wait for room on the disk: the last job to end found none.
  [[nodiscard]] std::optional<RetryLater> shortage() const;

 private:
  void check_open() const;
  [[nodiscard]] QueueState state();
  [[nodiscard]] std::vector<AtWork> at_work();
  [[nodiscard]] std::int64_t mean_ms() const;
  void load_lengths();
  [[nodiscard]] std::optional<store::JobRecord> same_name(const store::JobRecord& job);
  /// Of the job that has had the same question.
  struct Answer {
    std::string format;
    std::vector<Note> notes;  ///< of its report
  };
  [[nodiscard]] std::optional<Answer> find_answer(store::JobRecord& job);
  [[nodiscard]] std::optional<Answer> adopt_answer(const std::string& id,
                                                   const store::JobRecord& same);
  [[nodiscard]] bool enqueue(Submission& submission, const std::optional<Answer>& answer);
  [[nodiscard]] std::optional<store::JobRecord> keep_files(const Submission& submission);
  [[nodiscard]] store::JobRecord known_elsewhere(const store::JobRecord& job);
  void await_news(std::unique_lock<std::mutex>& lock);
  [[nodiscard]] std::optional<store::JobRecord> take_of(const std::string& owner);
  [[nodiscard]] bool answer_from_store(const store::JobRecord& job, const Answer& answer);
  enum class Found { lapsed, by_death, not_stopping };
  [[nodiscard]] bool is_poison(const store::JobRecord& job, Found found) const;
  void wait_or_end(const store::JobRecord& job, std::int64_t ran_ms);
  void give_up_excess();
  void remove_ended(const std::string& id);
  void take_up_left();
  void take_up(const store::JobRecord& job, Found found);
  void prolong_own();
  void take_up_lapsed();
  void give_up(const store::JobRecord& job, const Error& why);
  void set_aside(const store::JobRecord& unreadable);
  void wait_again(const store::JobRecord& job);
  [[nodiscard]] store::QueueCounts counts_if_reached();
  [[nodiscard]] std::shared_ptr<RunningJob> begin(store::JobRecord record);
  [[nodiscard]] store::JobOutcome sealed(const store::JobRecord& job, store::JobOutcome outcome);
  [[nodiscard]] bool wait_for_room(const RunningJob& job, const store::JobOutcome& outcome);
  /// Makes a change of a job in the store, and notes where its outcome is not known.
  template <class Change>
  auto noting_doubt(const std::string& id, const Change& change) {
    try {
      auto result = change();
      doubted_.erase(id);
      return result;
    } catch (const StoreAway& away) {
      if (away.in_doubt()) doubted_.insert(id);
      throw;
    }
  }
  void settle_end(const RunningJob& job, const store::JobOutcome& outcome,
                  const std::function<void()>& stored);
  [[nodiscard]] bool has_ended(const store::JobRecord& job, api::JobState state);
  void settle_doubt(const std::string& id);
  void take_up_stuck(const std::string& id);
  [[nodiscard]] bool is_known_elsewhere(const store::JobRecord& job) const;
  void mend_row(const store::JobRecord& job);
  void leave_to_others(const store::JobRecord& job, JobFeed& feed);
  void tell_end(const store::JobRecord& job);
  void publish(const store::JobRecord& job);
  [[nodiscard]] bool is_shared() const { return store_.node().is_shared; }
  void cancel_live(const store::JobRecord& job);
  /// False when another node has taken the job up, or ended it.
  bool end_job(const store::JobRecord& job, store::JobOutcome outcome,
               const std::function<void()>& stored = {});

  store::JobStore& store_;
  blobs::BlobStore& blobs_;
  EventFeed& events_;
  const Log& log_;
  const QueueConfig config_;

  std::function<void()> tell_jobs_wait_ = [] {};
  std::function<void()> tell_cancelled_ = [] {};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> closed_ = false;
  bool hurried_ = false;
  std::mutex naming_;  // one request with a name of its own at a time
  Admission door_;
  Lengths lengths_;           // of the newest jobs that ended, here or elsewhere
  std::int64_t all_workers_;  // of all nodes
  LeaseWatch leases_;
  Affinity affinity_;
  WorkSharing sharing_;
  store::QueueCounts counted_;
  std::optional<std::int64_t> first_waiting_ms_;  // as of counted_
  DiskFullBackoff pause_;
  std::deque<std::string> left_;  // by the last process, and not taken up yet
  bool tried_apart_ = false;
  bool must_mend_ = false;         // the store was away since mend() came to its end
  std::set<std::string> doubted_;  // jobs whose row or end may have been stored or not
  std::map<std::string, std::shared_ptr<RunningJob>, std::less<>> running_;
};

}  // namespace unwrapd::server::jobs
