#pragma once
// The events of a job, as frames of a text/event-stream. A job tells: queued, started, stage and
// iteration (many), then exactly one of succeeded, failed, cancelled. Who submits it and watches in
// one request is told first that it was accepted.

#include <cstdint>
#include <string>
#include <string_view>

#include "api/job.hpp"
#include "api/json.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::api {

struct Event {
  /// Counts up within a job; the frame's id, for Last-Event-ID. 0: of no place in the story, and
  /// without an id.
  std::int64_t seq = 0;
  std::string name;
  Json data = Json::object();
};

inline constexpr std::string_view kPing = ": ping\n\n";  ///< keeps an idle connection open

/// To who has submitted the job; its data is the job.
Event accepted_event(const Job& job);

/// Stage and iteration events of a curve say which lambda they are of. position: how many jobs are
/// ahead.
Event queued_event(std::int64_t seq, std::int64_t position);
Event started_event(std::int64_t seq, int attempt);
Event stage_event(std::int64_t seq, const StageEvent& stage);

/// ms: since the job was started.
Event iteration_event(std::int64_t seq, const IterationEvent& iteration, double ms);

/// Named by the job's state, which is final; its data is the job.
Event final_event(std::int64_t seq, const Job& job);

/// Events first..last are no longer kept. Its own id is last, so a reader goes on after them.
Event gap_event(std::int64_t first, std::int64_t last);

/// Whether the stream ends with this event.
bool is_last(const Event& event);

/// One frame: id (if any), event and data lines and the empty line that ends it. The data is one
/// line of JSON, in which line breaks of any text are escaped.
std::string sse_frame(const Event& event);

}  // namespace unwrapd::api
