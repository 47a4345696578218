#pragma once
// How a job ends that was told to stop: long work looks now and then, at most a few tens of
// milliseconds apart (`./dev bench cancel-latency` finds what goes longer without).

#include <stop_token>

namespace unwrapd {

/// Whether a stop was requested. All of core looks through this one function.
bool is_cancelled(const std::stop_token& stop);

/// Throws Error{cancelled} once a stop was requested.
void throw_if_cancelled(const std::stop_token& stop);

/// For loops: looks at every 4096th step.
template <class Number>
void check_cancelled_every(Number step, const std::stop_token& stop) {
  if (step % 4096 == 0) throw_if_cancelled(stop);
}

}  // namespace unwrapd
