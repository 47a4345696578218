#pragma once
// Packs islands on pages that others have places on already.

#include <optional>
#include <span>
#include <string>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/pack/pack.hpp"

namespace unwrapd::pack {

/// The page on which an island lies with all of its outline, in page units; -1: on none of so many.
int page_holding(const charts::Outline& island, double aspect, int pages);

/// Places for `islands` on the cells that `locked` leave free (some stay where they are if all of
/// them find no other), at least the padding from these,
/// each other and the border. All outlines are in page units, and every scale is 1, so that sizes
/// stay. The placements are those of `islands`. locked: each on a page (page_holding()). The same
/// bytes on every machine and for any number of threads. Throws Error{does_not_fit} at
/// /locked_islands if the pages do not suffice; Error{cancelled}.
PackResult pack_around(std::span<const charts::Outline> islands,
                       std::span<const charts::Outline> locked, const PageOptions& page,
                       Executor& executor);

/// The same with all of `islands` in new places; empty where the pages do not suffice. most_orders:
/// in which they are set down, tried one after another.
std::optional<PackResult> try_pack_around(std::span<const charts::Outline> islands,
                                          std::span<const charts::Outline> locked,
                                          const PageOptions& page, std::size_t most_orders,
                                          Executor& executor);

}  // namespace unwrapd::pack
