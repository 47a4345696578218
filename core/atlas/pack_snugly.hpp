#pragma once
// Many islands on one page.

#include <vector>

#include "core/atlas/arrange.hpp"
#include "core/atlas/pack.hpp"
#include "core/atlas/page_grid.hpp"
#include "core/executor.hpp"

namespace unwrapd {

/// The arranger's islands as large as fits. The same for any number of threads. Throws
/// Error{cancelled}.
std::vector<Placement> packed_snugly(const Arranger& arranger, const PageGrid& grid,
                                     Executor& executor);

}  // namespace unwrapd
