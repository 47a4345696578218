#pragma once
// Charts that were made to be few, whose maps may overlap.

#include <stop_token>
#include <vector>

#include "core/charts/charts.hpp"

namespace unwrapd::segment {

/// Each chart that was made at any distortion (Region::is_forced) and whose map overlaps has a
/// start that does not, with the seams that it has or cut anew, whichever has less distortion.
/// Where the component as one chart has less than these charts together, it is that. Throws
/// Error{cancelled}.
std::vector<charts::Chart> settle_forced(const charts::Chart& component,
                                         std::vector<charts::Chart> charts,
                                         const std::stop_token& stop);

}  // namespace unwrapd::segment
