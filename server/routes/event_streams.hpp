#pragma once
// Server-sent events: the feed of a job as the body of an answer. One thread writes the streams of
// all readers (stream_writer.hpp).

#include <memory>
#include <optional>
#include <string>

#include "server/base/concurrency_limit.hpp"
#include "server/http/http.hpp"
#include "server/jobs/event_feed.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::routes {

/// A reader of events. It may have a place before its job exists.
struct Watcher {
  std::string owner;                 ///< id of the API key, empty without one
  std::optional<std::int64_t> seen;  ///< Last-Event-ID
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

  /// Takes a place for a request that submits a job and then watches it. Throws like open().
  Watcher let_in(const http::Request& request);
  /// The answer to that submission: the job, then its events. Last-Event-ID is ignored unless the
  /// request has a name of its own: else the job is new.
  http::Response open_accepted(const store::JobRecord& job, const api::Job& shown, Watcher watcher);

  [[nodiscard]] int open_count() const { return places_.count(); }

 private:
  std::shared_ptr<void> take_place(const std::string& owner);
  http::Response stream(const store::JobRecord& job, Watcher watcher, std::string greeting);

  jobs::EventFeed& events_;
  const int max_streams_;
  ConcurrencyLimit places_;
};

}  // namespace unwrapd::server::routes
