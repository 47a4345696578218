#pragma once
// Packs groups of islands, each on a page of its own.

#include <span>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/pack/pack.hpp"

namespace unwrapd::pack {

/// group[k], from 0 on, is the page of island k. All islands have one density: the largest at which
/// each group fits on its page, or packing.texels_per_unit. Throws what pack() throws.
PackResult pack_groups(std::span<const charts::Outline> islands, std::span<const Index> group,
                       const PageOptions& page, Executor& executor);

}  // namespace unwrapd::pack
