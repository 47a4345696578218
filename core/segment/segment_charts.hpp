#pragma once
// Components made charts, each by the way that suits it and what was asked for.

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/types/cache_key.hpp"
#include "core/types/note.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::segment {

struct SegmentOptions {
  std::optional<double> max_distortion = {};  ///< empty: none for disks, kDefaultDistortion else
  std::optional<int> max_charts = {};         ///< of all surfaces together; empty: any number
  Effort effort = Effort::balanced;
  bool one_chart_each = false;        ///< components stay whole: what is no disk is cut to one
  Symmetry symmetry = Symmetry::off;  ///< of components that have a mirror plane
};

inline void describe(CacheKey& key, const SegmentOptions& options) {
  const auto& [max_distortion, max_charts, effort, one_chart_each, symmetry] = options;
  key.add(max_distortion).add(max_charts).add(effort).add(one_chart_each).add(symmetry);
}

/// How the work is watched; calls come from the thread that called.
struct SegmentWatch {
  std::function<void(Stage, double)> on_progress = {};  ///< the share that is done, [0, 1]
  std::stop_token stop = {};
};

/// The components of surfaces (components_of()) become charts, all of them disks, and the repairs
/// tell what was done. A disk stays as it is unless a distortion is asked for; any other component
/// is taken apart by segment(), or cut to one disk where it shall be one chart and no distortion is
/// asked for. Returns a note where more charts than asked for are needed, or noise leaves no room
/// for the distortion, else nothing. The same for any executor. Throws Error{cancelled}.
std::optional<Note> segment_charts(std::vector<charts::Charts>& surfaces,
                                   const SegmentOptions& options, const SegmentWatch& watch,
                                   Executor& executor);

}  // namespace unwrapd::segment
