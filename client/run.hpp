#pragma once
// Runs the whole command, from arguments to files.

#include <iosfwd>
#include <stop_token>

#include "client/arguments.hpp"
#include "client/progress.hpp"

namespace unwrapd::client {

/// The output streams: the summary goes to out, or to err where a file goes to standard output;
/// progress goes to err.
struct Console {
  std::ostream& out;
  std::ostream& err;
  ProgressStyle style = ProgressStyle::lines;
  std::size_t width = 80;
};

/// Sends the mesh, follows the job, writes the files. When stop is requested the job is cancelled.
/// Throws Failure.
void run(const Arguments& arguments, const Console& console, const std::stop_token& stop);

}  // namespace unwrapd::client
