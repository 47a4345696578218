#pragma once
// Packs few islands on one page.

#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/pack/compact.hpp"
#include "core/pack/pack.hpp"
#include "core/pack/page_grid.hpp"

namespace unwrapd::pack {

inline constexpr std::size_t kFewOnAPage = 40;     ///< at most
inline constexpr std::size_t kFewWithSmall = 120;  ///< the same where only kFewOnAPage are large

/// The first compaction: on a coarse grid, with moves to any place.
inline constexpr CompactRules kFirstCompaction{128, 0, 1, 14};

/// The amount of work to spend, 12 at most: the number of islands, or less if they have few sides.
double shares_of(std::span<const charts::Outline> islands);

/// Packs the islands as large as they fit; empty if no packing without overlaps was found. There
/// are at least two, one of which has extent. The same for any number of threads. Throws
/// Error{cancelled}.
std::optional<std::vector<Placement>> pack_few(std::span<const charts::Outline> islands,
                                               const PageGrid& grid, Rotation rotation,
                                               Effort effort, Executor& executor);

}  // namespace unwrapd::pack
