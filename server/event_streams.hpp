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

/// Thread-safe.
class EventStreams {
 public:
  EventStreams(EventFeed& events, int max_streams) : events_(events), max_streams_(max_streams) {}

  /// The events of a job after Last-Event-ID. A job whose feed is gone is final: its last event is
  /// made from the record. Throws RetryLater{too_many_streams}, Error{malformed_request}.
  Response open(const JobRecord& job, const std::string& last_event_id);

  [[nodiscard]] int open_count() const { return *open_; }

 private:
  std::shared_ptr<void> take_place();

  EventFeed& events_;
  const int max_streams_;
  std::shared_ptr<std::atomic<int>> open_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace unwrapd::server
