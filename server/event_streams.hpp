#pragma once
// Server-sent events: a job's feed as the body of an answer, which one thread writes for all
// readers (stream_writer.hpp).

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "server/event_feed.hpp"
#include "server/http.hpp"
#include "server/job_record.hpp"

namespace unwrapd::server {

/// Of a reader who is let in before there is a job to watch.
struct Watcher {
  std::optional<std::int64_t> seen;  ///< the last event, by its own account
  std::shared_ptr<void> place;       ///< among the streams
};

/// Thread-safe.
class EventStreams {
 public:
  EventStreams(EventFeed& events, int max_streams) : events_(events), max_streams_(max_streams) {}

  /// The events of a job after Last-Event-ID. A job whose feed is gone is final: its last event is
  /// made from the record. Throws RetryLater{too_many_streams}, Error{malformed_request}.
  Response open(const JobRecord& job, const std::string& last_event_id);

  /// Lets somebody in who is about to submit a job and will watch it. Throws like open().
  Watcher let_in(const std::string& last_event_id);
  /// The answer to that submission: the job, then its events. A job without a name of the sender's
  /// is a new one, of which nothing was seen.
  Response open_accepted(const JobRecord& job, Watcher watcher);

  [[nodiscard]] int open_count() const { return *open_; }

 private:
  std::shared_ptr<void> take_place();
  Response stream(const JobRecord& job, Watcher watcher, std::string greeting);

  EventFeed& events_;
  const int max_streams_;
  std::shared_ptr<std::atomic<int>> open_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace unwrapd::server
