#pragma once
// The events of jobs, from the worker to any number of readers. A feed is a bounded ring: a worker
// never waits for a reader, and a slow reader gets an event that names the gap. Sequence numbers
// rise over attempts and restarts: attempt k of a job begins at k * 10^9. Where several nodes serve
// one store, the feed of a job that runs elsewhere follows the feed there (event_exchange.hpp).

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "api/events.hpp"
#include "server/base/wakeup.hpp"
#include "server/jobs/job_metrics.hpp"
#include "server/store/event_channel.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::jobs {

/// What a reader gets from one call.
struct Reading {
  std::string frames;         ///< whole frames, empty when nothing is new
  std::int64_t last_seq = 0;  ///< of the last event read
  bool end = false;           ///< nothing will follow
};

/// The numbers of an attempt, in parts of which each has one writer: the node that queued the job,
/// one that ends it without running it, and the one that runs it.
inline constexpr std::int64_t kSeqsPerAttempt = 1'000'000'000;
inline constexpr std::int64_t kSeqsOfEnds = 500'000;   ///< where the second part begins
inline constexpr std::int64_t kSeqsOfRun = 1'000'000;  ///< and the third

/// The events of one job. Thread-safe.
class JobFeed {
 public:
  using Share = std::function<void(store::EventRow event)>;

  /// Belongs to the trace of the calling thread, or to a new one. share: called for each event that
  /// is published here, in order. waited: how long the job has waited, for the metrics.
  JobFeed(std::int64_t base, std::size_t capacity, Metrics* metrics = nullptr,
          std::shared_ptr<const Wakeup> news = nullptr, Share share = {},
          std::chrono::milliseconds waited = {});

  /// The trace id of the job's log lines.
  [[nodiscard]] const std::string& trace() const { return trace_; }

  /// Appends the event that make(seq) returns; a final event finishes the feed.
  void publish(const std::function<api::Event(std::int64_t seq)>& make);
  void set_progress(const api::JobProgress& progress);
  [[nodiscard]] std::optional<api::JobProgress> progress() const;
  /// Ends all readings without a final event, as the server stops.
  void end();

  /// The sequence number that the next event will get.
  [[nodiscard]] std::int64_t next_seq() const;
  /// The next event will have a number above this one.
  void rise_to(std::int64_t seq);

  /// Whether the job runs elsewhere, and append() adds its events.
  [[nodiscard]] bool is_following() const { return following_; }
  void follow(bool following) { following_ = following; }
  /// Adds an event of another node, unless one of its number or a later one is there. Where events
  /// before it were lost, readers get one that names the gap.
  void append(const store::EventRow& event);
  [[nodiscard]] bool is_finished() const;
  [[nodiscard]] std::int64_t newest() const;
  /// What there was when it began to follow is there now.
  void set_caught_up();
  void wait_caught_up(std::chrono::milliseconds at_most) const;
  /// The event after which a reader with this Last-Event-ID goes on. A reader that has seen the end
  /// sees it again.
  [[nodiscard]] std::int64_t resume_after(std::optional<std::int64_t> last_event_id) const;
  /// The events after `after`, a few kB of them at most. `news` is rung when there are more.
  [[nodiscard]] Reading read(std::int64_t after) const;
  /// True when the final event is at or before `after`.
  [[nodiscard]] bool wait_finished(std::chrono::steady_clock::time_point until) const;

 private:
  struct Frame {
    std::int64_t seq;
    std::string text;
  };
  [[nodiscard]] bool over() const { return finished_ || ended_; }
  void tell_news(bool is_over);
  void keep(Frame frame);

  const std::int64_t base_;
  const std::string trace_;
  mutable std::mutex mutex_;
  mutable std::condition_variable over_;
  const std::shared_ptr<const Wakeup> news_;
  const Share share_;
  std::int64_t newest_;
  std::int64_t forgotten_;  // the newest that is no longer kept
  const std::size_t capacity_;
  std::deque<Frame> ring_;
  std::optional<api::JobProgress> progress_;
  std::optional<JobMetrics> watch_;
  bool finished_ = false;
  bool ended_ = false;
  bool caught_up_ = false;
  std::atomic<bool> following_ = false;
};

/// All feeds: those of live jobs and, for late readers, those of the last finished ones.
class EventFeed {
 public:
  /// ring: events kept of a job; kept_finished: finished feeds kept; metrics: counts all events,
  /// must outlive all feeds; news: rung at every event.
  explicit EventFeed(std::size_t ring = 1024, std::size_t kept_finished = 64,
                     Metrics* metrics = nullptr, std::shared_ptr<const Wakeup> news = nullptr)
      : ring_(ring), kept_finished_(kept_finished), metrics_(metrics), news_(std::move(news)) {}

  /// From now on, other nodes are told of events; found: called with the id of a job that begins to
  /// be followed here.
  void share_with(std::function<void(store::EventRow event)> share,
                  std::function<void(const std::string& job)> found);

  /// The feed of a job that waits for its next attempt; attempt: those begun before; waited: how
  /// long it has waited already.
  std::shared_ptr<JobFeed> open(const std::string& job, int attempt,
                                std::chrono::milliseconds waited = {});
  /// The feed of a job, which follows it where it runs elsewhere. nullptr when the job has ended,
  /// or nothing runs elsewhere, and there is none.
  std::shared_ptr<JobFeed> find_or_follow(const store::JobRecord& job);
  /// All that follow, by job.
  [[nodiscard]] std::vector<std::pair<std::string, std::shared_ptr<JobFeed>>> following() const;
  [[nodiscard]] std::shared_ptr<JobFeed> find(std::string_view job) const;
  /// Marks a job as finished: its feed is kept until newer ones replace it.
  void retire(const std::string& job);
  void forget(const std::string& job);
  void end_all();

 private:
  std::shared_ptr<JobFeed> make(const std::string& job, int attempt,
                                std::chrono::milliseconds waited = {});

  const std::size_t ring_;
  const std::size_t kept_finished_;
  Metrics* const metrics_;
  const std::shared_ptr<const Wakeup> news_;
  std::function<void(store::EventRow event)> share_;
  std::function<void(const std::string& job)> found_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<JobFeed>, std::less<>> feeds_;
  std::list<std::string> finished_;
};

}  // namespace unwrapd::server::jobs
