#pragma once
// One mesh from its file to the files of its answer.

#include <iosfwd>
#include <stop_token>
#include <vector>

#include "client/arguments.hpp"
#include "client/files_beside.hpp"
#include "client/outputs.hpp"
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

/// What is sent with arguments.file, for the result to be complete.
WantedFiles wanted_files(const Arguments& arguments);

/// Sends arguments.file, or its address, and follows the job to its success, as unwrap_file();
/// returns its id.
std::string finished_job(JobClient& client, const Arguments& arguments, const Console& console,
                         const std::stop_token& stop);

/// Sends arguments.file, follows the job, writes the files. When stop is requested the job is
/// cancelled. Requires check_outputs(). Throws Failure.
std::vector<WrittenMap> unwrap_file(JobClient& client, const Arguments& arguments,
                                    const Console& console, const std::stop_token& stop);

}  // namespace unwrapd::client
