#pragma once
// A surface of any genus taken apart into few regions that ARAP lays flat with little distortion.

#include <functional>
#include <limits>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/segment/merge.hpp"
#include "core/segment/sheet.hpp"
#include "core/types/options.hpp"
#include "core/types/progress.hpp"

namespace unwrapd {

struct SegmentRules {
  double max_distortion = 2.02;  ///< of all regions together, D_angle and D_area each; > 2
  /// A looser bound is approached in steps from this one, so that it never has longer seams than a
  /// tighter one above this. At the bound itself it is searched for anew.
  double first_distortion = kDefaultDistortion;
  Index most_regions = std::numeric_limits<Index>::max();  ///< however distorted, if maps allow it
  double page_area = 1;   ///< of all that lies on one page with this sheet, in units of its area
  bool is_quick = false;  ///< one merge, no search for the best
  std::function<void(Stage, double)> on_progress = {};  ///< the share that is done
  std::stop_token stop = {};
};

struct Segments {
  std::vector<Region> regions;
  std::vector<char> open;  ///< one a half-edge of the sheet, 1: a seam inside a region
  Excess excess = {};      ///< of all maps, over the sheet's area
};

/// Every face of the sheet is in exactly one region; each region is a disk (holes allowed) whose
/// map has no flip and no overlap. Ends with single triangles in the worst case. The same for any
/// executor, and for the sheet of a mesh that was moved or scaled. Throws Error{cancelled}.
Segments segment(const Sheet& sheet, const SegmentRules& rules, Executor& executor);

}  // namespace unwrapd
