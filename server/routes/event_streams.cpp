#include "server/routes/event_streams.hpp"

#include <utility>

#include "core/base/parse_number.hpp"
#include "server/jobs/job_queue.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr int kRetrySeconds = 5;

std::optional<std::int64_t> parse_event_id(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto id = parse_number<std::int64_t>(text);
  if (!id || *id < 0) {
    throw Error(ErrorCode::malformed_request,
                "Last-Event-ID is not the id of an event; leave it out to read from the first.");
  }
  return id;
}

/// The position of a reader, and its place among the streams.
struct Reader {
  std::shared_ptr<const jobs::JobFeed> feed;
  std::int64_t after = 0;
  std::shared_ptr<void> place;
  std::string greeting;  // sent first
};

http::StreamPiece next_piece(Reader& reader) {
  if (!reader.greeting.empty()) return {.bytes = std::exchange(reader.greeting, {}), .end = false};
  jobs::Reading reading = reader.feed->read(reader.after);
  reader.after = reading.last_seq;
  return {.bytes = std::move(reading.frames), .end = reading.end};
}

Watcher watcher_of(const http::Request& request) {
  return {.owner = request.caller.owner,
          .seen = parse_event_id(request.header("Last-Event-ID")),
          .place = {}};
}

/// The last frames of a job whose events are no longer kept.
std::string last_frames(const store::JobRecord& job, std::int64_t seen) {
  std::string frames;
  if (seen + 1 < job.last_event)
    frames = api::sse_frame(api::gap_event(seen + 1, job.last_event - 1));
  return frames + api::sse_frame(api::final_event(job.last_event, store::to_job(job)));
}

}  // namespace

std::shared_ptr<void> EventStreams::take_place(const std::string& owner) {
  std::shared_ptr<void> place = places_.try_enter(owner);
  if (place) return place;
  throw RetryLater(ErrorCode::too_many_streams,
                   "All " + std::to_string(max_streams_) +
                       " event streams are taken, or this API key has its share of them; try again "
                       "after Retry-After.",
                   kRetrySeconds);
}

http::Response EventStreams::stream(const store::JobRecord& job, Watcher watcher,
                                    std::string greeting) {
  http::Response response;
  response.content_type = "text/event-stream";
  response.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}};
  const std::shared_ptr<jobs::JobFeed> feed = events_.find_or_follow(job);
  if (!feed) {
    response.body = greeting + last_frames(job, watcher.seen.value_or(0));
    return response;
  }
  if (!watcher.place) watcher.place = take_place(watcher.owner);
  auto reader = std::make_shared<Reader>(Reader{.feed = feed,
                                                .after = feed->resume_after(watcher.seen),
                                                .place = std::move(watcher.place),
                                                .greeting = std::move(greeting)});
  response.body =
      http::StreamBody{.next = [reader] { return next_piece(*reader); }, .ping = api::kPing};
  return response;
}

http::Response EventStreams::open(const store::JobRecord& job, const http::Request& request) {
  return stream(job, watcher_of(request), {});
}

Watcher EventStreams::let_in(const http::Request& request) {
  Watcher watcher = watcher_of(request);
  watcher.place = take_place(watcher.owner);
  return watcher;
}

http::Response EventStreams::open_accepted(const store::JobRecord& job, const api::Job& shown,
                                           Watcher watcher) {
  if (job.request_key.empty()) watcher.seen.reset();
  return stream(job, std::move(watcher), api::sse_frame(api::accepted_event(shown)));
}

}  // namespace unwrapd::server::routes
