#pragma once
// The events of jobs on other nodes of the same store. A thread with one session writes the events
// of this node's jobs, a few at a time, and sends hints; it waits for hints, and fills the feeds of
// jobs that run elsewhere. Whatever a hint says is also looked for once a second, so that a lost
// hint costs time alone. While the database is away, events wait; of too many, the oldest are given
// up, and so are those that it refuses. Readers elsewhere see a gap.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/base/log.hpp"
#include "server/base/wakeup.hpp"
#include "server/jobs/event_feed.hpp"
#include "server/store/event_channel.hpp"

namespace unwrapd::server::jobs {

/// What a node does when it is told, or finds by looking, that others did something.
struct ExchangeCallbacks {
  std::function<void()> jobs_wait;
  std::function<void()> jobs_cancelled;  ///< of this node
  std::function<void(const std::string& job)> job_ended;
};

/// Thread-safe. The feeds and what the callbacks use must outlive it.
class EventExchange {
 public:
  EventExchange(database::PostgresAddress address, EventFeed& events, ExchangeCallbacks callbacks,
                const Log& log);
  ~EventExchange();

  /// Writes an event for other nodes.
  void share(store::EventRow event);
  /// Tells other nodes that jobs wait, or that one was cancelled.
  void tell_jobs_wait() { hint(kJobsWait); }
  void tell_cancelled() { hint(kCancelled); }
  /// A job is followed from now on: what there is of it is fetched at once.
  void fetch_now() {
    must_fetch_ = true;
    bell_.ring();
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Feeds = std::vector<std::pair<std::string, std::shared_ptr<JobFeed>>>;

  static constexpr std::string_view kJobsWait = "wait";
  static constexpr std::string_view kCancelled = "cancel";
  static constexpr std::string_view kEvents = "events ";

  void hint(std::string_view what);
  void keep_trying(const std::stop_token& stop);
  void exchange(const std::stop_token& stop);
  [[nodiscard]] bool has_to_write();
  void write(store::EventChannel& channel);
  void send(store::EventChannel& channel, std::string_view hint);
  void append(store::EventChannel& channel);
  void take_hints(store::EventChannel& channel, const std::vector<std::string>& hints);
  [[nodiscard]] bool take_hint(const std::string& hint, std::set<std::string>& with_news);
  void fetch(store::EventChannel& channel, const Feeds& feeds);
  void look_around(store::EventChannel& channel);

  const database::PostgresAddress address_;
  EventFeed& events_;
  const ExchangeCallbacks callbacks_;
  const Log& log_;
  Wakeup bell_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<store::EventRow> to_write_;
  std::vector<std::string> to_hint_;
  std::atomic<bool> must_fetch_ = false;
  std::vector<store::EventRow> unsent_;  // of to_write_, those that are written now
  std::set<std::string> ended_before_;   // of those that were found at the last look
  bool can_hint_ = true;                 // as far as is known
  std::jthread exchanging_;              // last: it uses the others
};

}  // namespace unwrapd::server::jobs
