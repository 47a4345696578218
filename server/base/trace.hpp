#pragma once
// Which request a thread works for: the trace id of W3C Trace Context (Recommendation, 2021), taken
// over from the header traceparent or made here, told in every log line and in the answer.
//
// The id lies in a thread's own variable, since log lines are written where nothing knows of
// requests; handing it through every signature was rejected for that.

#include <string>
#include <string_view>

namespace unwrapd::server {

struct Trace {
  std::string id;    ///< 32 lowercase hex digits
  std::string span;  ///< 16, of our part of the work
  std::string flags = "00";
};

std::string new_trace_id();
/// The trace that a traceparent names, with a span of our own; a new one when it names none.
Trace continue_trace(std::string_view traceparent);
/// A further span of this trace; of a new one when there is none.
Trace step_of(std::string_view id);
/// "00-{id}-{span}-{flags}"
std::string to_traceparent(const Trace& trace);

/// The id that this thread works for, empty when for none.
const std::string& current_trace();

/// While it lives, this thread works for a trace.
class TraceScope {
 public:
  explicit TraceScope(std::string id);
  TraceScope(const TraceScope&) = delete;
  TraceScope& operator=(const TraceScope&) = delete;
  ~TraceScope();

 private:
  std::string before_;
};

}  // namespace unwrapd::server
