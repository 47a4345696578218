#pragma once
// Neighbouring regions made one, greedily, as long as their maps stay good.

#include <functional>
#include <stop_token>
#include <vector>

#include "core/atlas/trial.hpp"
#include "core/executor.hpp"

namespace unwrapd {

/// A region with the map that it has so far.
struct Patch {
  Region region;
  Excess excess;          ///< of that map
  double area = 0;        ///< of the sheet's 1
  bool is_sound = false;  ///< its map is; what is not sound merges with nothing
};

struct MergeRules {
  double budget = 0;  ///< neither sum of the patches' excess rises above this
  double cap = 0;     ///< excess of one patch over its area, at most, where a union adds some
  Index enough = 1;   ///< ends when there are no more patches than this
  std::function<void(double)> on_progress = {};  ///< share of the patches merged, from this thread
  std::stop_token stop = {};
};

/// open: see try_map(). The same for any executor. Throws Error{cancelled}.
std::vector<Patch> merge_patches(const Sheet& sheet, std::span<const char> open,
                                 std::vector<Patch> patches, const MergeRules& rules,
                                 Executor& executor);

}  // namespace unwrapd
