#pragma once
// Two meshes with the UVs that they have, side by side.

#include <stop_token>

#include "client/unwrap_file.hpp"

namespace unwrapd::client {

/// Measures both files of arguments.inputs by jobs with measure_only. Prints a table of their
/// figures, or their reports as a list of JSON, and writes a page with their pictures to
/// arguments.out, if it is given. Throws Failure.
void compare(const Arguments& arguments, const Servers& servers, const Console& console,
             const std::stop_token& stop);

}  // namespace unwrapd::client
