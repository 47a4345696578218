#include "core/asset/gltf/runs.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

#include "core/asset/base/bytes.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kAlignment = 8;  // of runs of bytes, as they had in their buffers

}  // namespace

std::vector<Run> merged(std::vector<Run> runs) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
    return std::pair(a.buffer, a.begin) < std::pair(b.buffer, b.begin);
  });
  std::vector<Run> merged;
  for (const Run& run : runs) {
    if (!merged.empty() && merged.back().buffer == run.buffer && run.begin <= merged.back().end)
      merged.back().end = std::max(merged.back().end, run.end);
    else
      merged.push_back(run);
  }
  return merged;
}

void append_runs(std::string& bytes, const std::vector<std::string_view>& buffers,
                 std::vector<Run>& runs) {
  for (Run& run : runs) {
    pad(bytes, kAlignment);
    bytes.append(run.begin % kAlignment, '\0');
    run.target = bytes.size();
    bytes += buffers[run.buffer].substr(run.begin, run.end - run.begin);
  }
}

const Run& run_of(const std::vector<Run>& runs, std::size_t buffer, std::size_t offset) {
  const auto after = std::upper_bound(
      runs.begin(), runs.end(), std::pair(buffer, offset),
      [](const auto& at, const Run& run) { return at < std::pair(run.buffer, run.begin); });
  assert(after != runs.begin());
  return *std::prev(after);
}

}  // namespace unwrapd::asset
