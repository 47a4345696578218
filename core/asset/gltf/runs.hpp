#pragma once
// Runs of bytes of a file: bytes that several views share are included once.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::asset {

/// A run of bytes of a buffer, and its position in the file.
struct Run {
  std::size_t buffer = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t target = 0;
};

/// Joins runs that touch or overlap; in order.
std::vector<Run> merged(std::vector<Run> runs);

/// Appends the bytes of the runs, each at the alignment that it had, and sets their positions.
void append_runs(std::string& bytes, const std::vector<std::string_view>& buffers,
                 std::vector<Run>& runs);

/// The run that contains the byte; it exists.
const Run& run_of(const std::vector<Run>& runs, std::size_t buffer, std::size_t offset);

}  // namespace unwrapd::asset
