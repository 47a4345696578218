#include "server/base/trace.hpp"

#include <algorithm>

#include "server/base/identity.hpp"

namespace unwrapd::server {
namespace {

constexpr std::size_t kIdDigits = 32;
constexpr std::size_t kSpanDigits = 16;
constexpr std::size_t kIdAt = 3;
constexpr std::size_t kSpanAt = kIdAt + kIdDigits + 1;
constexpr std::size_t kFlagsAt = kSpanAt + kSpanDigits + 1;
constexpr std::size_t kLength = kFlagsAt + 2;

thread_local std::string of_this_thread;  // NOLINT: see the header

bool is_hex(std::string_view text) {
  return std::ranges::all_of(
      text, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool is_zero(std::string_view text) {
  return text.find_first_not_of('0') == std::string_view::npos;
}

/// Version 00; additions of a later version are skipped, as the standard asks.
bool is_traceparent(std::string_view text) {
  if (text.size() < kLength || (text.size() > kLength && text[kLength] != '-')) return false;
  const std::string_view version = text.substr(0, 2);
  const bool dashes =
      text[kIdAt - 1] == '-' && text[kSpanAt - 1] == '-' && text[kFlagsAt - 1] == '-';
  if (!dashes || !is_hex(version) || version == "ff") return false;
  if (version == "00" && text.size() != kLength) return false;
  const std::string_view id = text.substr(kIdAt, kIdDigits);
  const std::string_view span = text.substr(kSpanAt, kSpanDigits);
  return is_hex(id) && !is_zero(id) && is_hex(span) && !is_zero(span) &&
         is_hex(text.substr(kFlagsAt, 2));
}

}  // namespace

std::string new_trace_id() { return random_job_id().substr(2); }  // both are 128 random bits

Trace step_of(std::string_view id) {
  Trace trace{.id = new_trace_id(), .span = new_trace_id().substr(0, kSpanDigits)};
  if (!id.empty()) trace.id = id;
  return trace;
}

Trace continue_trace(std::string_view traceparent) {
  Trace trace = step_of({});
  if (!is_traceparent(traceparent)) return trace;
  trace.id = traceparent.substr(kIdAt, kIdDigits);
  trace.flags = traceparent.substr(kFlagsAt, 2);
  return trace;
}

std::string to_traceparent(const Trace& trace) {
  return "00-" + trace.id + "-" + trace.span + "-" + trace.flags;
}

const std::string& current_trace() { return of_this_thread; }

TraceScope::TraceScope(std::string id) : before_(std::move(of_this_thread)) {
  of_this_thread = std::move(id);
}

TraceScope::~TraceScope() { of_this_thread = std::move(before_); }

}  // namespace unwrapd::server
