#include "client/nearest.hpp"

#include <algorithm>

#include "api/edit_distance.hpp"

namespace unwrapd::client {
namespace {

constexpr std::size_t kMostEdits = 2;

}  // namespace

const std::string* nearest(std::string_view given, std::span<const std::string> words) {
  const std::string* best = nullptr;
  std::size_t fewest = std::min(kMostEdits + 1, given.size());
  for (const std::string& word : words)
    if (const std::size_t edits = api::edit_distance(given, word); edits < fewest) {
      fewest = edits;
      best = &word;
    }
  return best;
}

}  // namespace unwrapd::client
