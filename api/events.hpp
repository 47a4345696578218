#pragma once
// The events of a job, as frames of a text/event-stream: queued, started, stage and iteration
// (many), a note for each of the report's, then exactly one of succeeded, failed, cancelled. A
// client that submits and watches in one request first receives the event accepted.

#include <cstdint>
#include <string>
#include <string_view>

#include "api/job.hpp"
#include "api/json.hpp"
#include "core/types/note.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::api {

struct Event {
  /// Counts up within a job; the frame's id, for Last-Event-ID. 0: the event has no place in the
  /// order and no id.
  std::int64_t seq = 0;
  std::string name;
  Json data = Json::object();
};

inline constexpr std::string_view kPing = ": ping\n\n";  ///< keeps an idle connection open

/// The first event for a client that submits and watches; its data is the job.
Event accepted_event(const Job& job);

/// Stage and iteration events of a curve name their lambda. position: number of jobs ahead.
Event queued_event(std::int64_t seq, std::int64_t position);
Event started_event(std::int64_t seq, int attempt);
Event stage_event(std::int64_t seq, const StageEvent& stage);

/// ms: since the start of the job.
Event iteration_event(std::int64_t seq, const IterationEvent& iteration, double ms);

Event note_event(std::int64_t seq, const Note& note);

/// Its name is the job's final state; its data is the job.
Event final_event(std::int64_t seq, const Job& job);

/// Tells that events first..last are no longer stored. Its own id is last, so that a reader
/// continues after them.
Event gap_event(std::int64_t first, std::int64_t last);

/// Whether the stream ends with this event.
bool is_last(const Event& event);

/// One frame: id (if any), event and data lines and the empty line that ends it. The data is one
/// line of JSON, whose texts have escaped line breaks.
std::string sse_frame(const Event& event);

}  // namespace unwrapd::api
