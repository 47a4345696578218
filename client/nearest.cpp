#include "client/nearest.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace unwrapd::client {
namespace {

constexpr std::size_t kMostEdits = 2;

std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);  // from the first i letters of a
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, changed}));
    }
  }
  return row.back();
}

}  // namespace

const std::string* nearest(std::string_view given, std::span<const std::string> words) {
  const std::string* best = nullptr;
  std::size_t fewest = std::min(kMostEdits + 1, given.size());
  for (const std::string& word : words)
    if (const std::size_t edits = edits_between(given, word); edits < fewest) {
      fewest = edits;
      best = &word;
    }
  return best;
}

}  // namespace unwrapd::client
