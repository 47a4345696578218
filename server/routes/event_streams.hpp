#pragma once
// Server-sent events: a job's feed as the body of an answer, which one thread writes for all
// readers (stream_writer.hpp).

#include <memory>
#include <optional>
#include <string>

#include "server/base/concurrency_limit.hpp"
#include "server/http/http.hpp"
#include "server/jobs/event_feed.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::routes {

/// A reader, who may be let in before there is a job to watch.
struct Watcher {
  std::string owner;                 ///< id of the API key, empty without one
  std::optional<std::int64_t> seen;  ///< the last event, by its own account
  std::shared_ptr<void> place;       ///< among the streams
};

/// Thread-safe. Outlives the answers.
class EventStreams {
 public:
  EventStreams(jobs::EventFeed& events, int max_streams)
      : events_(events), max_streams_(max_streams), places_(max_streams, half_of_the_rest) {}

  /// The events of a job after Last-Event-ID. A job whose feed is gone is final: its last event is
  /// made from the record, after a gap for all that were before it. Throws
  /// RetryLater{too_many_streams}, Error{malformed_request}.
  http::Response open(const store::JobRecord& job, const http::Request& request);

  /// Lets somebody in who is about to submit a job and will watch it. Throws like open().
  Watcher let_in(const http::Request& request);
  /// The answer to that submission: the job, then its events. A job without a name of the sender's
  /// is a new one, of which nothing was seen.
  http::Response open_accepted(const store::JobRecord& job, Watcher watcher);

  [[nodiscard]] int open_count() const { return places_.count(); }

 private:
  std::shared_ptr<void> take_place(const std::string& owner);
  http::Response stream(const store::JobRecord& job, Watcher watcher, std::string greeting);

  jobs::EventFeed& events_;
  const int max_streams_;
  ConcurrencyLimit places_;
};

}  // namespace unwrapd::server::routes
