#pragma once
// Packs many islands on one page.

#include <vector>

#include "core/base/executor.hpp"
#include "core/pack/bottom_left.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {

/// Places the placer's islands as large as they fit. The same for any number of threads. Throws
/// Error{cancelled}.
std::vector<Placement> pack_many(const BottomLeftPlacer& placer, const PageGrid& grid,
                                 Effort effort, Executor& executor);

}  // namespace unwrapd::pack
