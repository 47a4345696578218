#pragma once
// Few islands on one page.

#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/pack/compact.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {

inline constexpr std::size_t kFewOnAPage = 40;  ///< at most

/// How islands are squeezed first: on a coarse grid, from anywhere to anywhere.
inline constexpr CompactRules kFirstCompaction{128, 0, 1, 14};

/// A measure of how much there is to try, 12 at most: islands, or less where they have few sides.
double shares_of(std::span<const charts::Outline> islands);

/// The islands as large as fits; nothing where they found no place apart. At least two, one of
/// which has extent. The same for any number of threads. Throws Error{cancelled}.
std::optional<std::vector<Placement>> pack_few(std::span<const charts::Outline> islands,
                                               const PageGrid& grid, Executor& executor);

}  // namespace unwrapd::pack
