#pragma once
// Packs islands of which few hold most of the area.

#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/pack/pack.hpp"

namespace unwrapd::pack {

/// How many of the largest islands hold nine tenths of the area of all.
std::size_t count_large(std::span<const charts::Outline> islands);

/// Packs the largest islands as pack_few() does and sets the others around them and into their
/// holes. Empty where there are no others, where none has an area, and where the others do not fit.
/// The same for any number of threads. Throws Error{cancelled}.
std::optional<std::vector<Placement>> pack_large_first(std::span<const charts::Outline> islands,
                                                       const PageOptions& page, Executor& executor);

}  // namespace unwrapd::pack
