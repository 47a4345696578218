#include "core/segment/base/search_extent.hpp"

#include <array>
#include <limits>

namespace unwrapd::segment {
namespace {

constexpr double kNever = 1e9;
constexpr StandIn kNone{std::numeric_limits<Index>::max(), 0};

constexpr std::array kExtents = {
    SearchExtent{50'000, 2, 1, 0, .35, .1, kNone, {5'000, 3'000, 7'000}},     // fast
    SearchExtent{100'000, 3, 1, 8, 1, .5, {6'000, 4'000}, {18'000, 12'000}},  // balanced
    SearchExtent{100'000, 12, 2, 40, kNever, 1, kNone, {18'000, 12'000}},     // best
};

}  // namespace

SearchExtent search_extent(Effort effort) { return kExtents[static_cast<std::size_t>(effort)]; }

}  // namespace unwrapd::segment
