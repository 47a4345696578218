#pragma once
// Many islands on one page.

#include <vector>

#include "core/base/executor.hpp"
#include "core/pack/arrange.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd {

/// The arranger's islands as large as fits. The same for any number of threads. Throws
/// Error{cancelled}.
std::vector<Placement> packed_snugly(const Arranger& arranger, const PageGrid& grid,
                                     Executor& executor);

}  // namespace unwrapd
