#pragma once
// Several meshes in one command: as many at once as --jobs says, or as the workers take, and a
// table at the end.

#include <stop_token>

#include "client/arguments.hpp"
#include "client/unwrap_file.hpp"

namespace unwrapd::client {

/// Unwraps all files that the inputs name; with --watch, also those that come or change later,
/// until it is stopped. One that fails does not keep the others from being unwrapped. Throws
/// Failure: job_failed at the end if any failed, unreachable, interrupted.
void run_batch(const Arguments& arguments, const Servers& servers, const Console& console,
               const std::stop_token& stop);

}  // namespace unwrapd::client
