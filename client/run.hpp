#pragma once
// Runs the whole command, from arguments to files.

#include <stop_token>

#include "client/arguments.hpp"
#include "client/unwrap_file.hpp"

namespace unwrapd::client {

/// Unwraps the meshes of the command and tells what became of them. When stop is requested the job
/// is cancelled. Throws Failure.
void run(const Arguments& arguments, const Console& console, const std::stop_token& stop);

}  // namespace unwrapd::client
