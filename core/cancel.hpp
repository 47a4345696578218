#pragma once
// How a job ends that was told to stop.

#include <stop_token>

#include "core/error.hpp"

namespace unwrapd {

/// Throws Error{cancelled} once a stop was requested.
inline void throw_if_cancelled(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "the job was cancelled");
}

}  // namespace unwrapd
