#pragma once
// Stacks congruent islands on one place of the page.

#include <functional>

#include "core/pack/pack.hpp"

namespace unwrapd::pack {

/// pack_shapes packs one island of each shape, with the outlines of all that are stacked on it.
/// Where rotation is none, only islands that lie alike are stacked. Throws Error{cancelled}, and
/// what pack_shapes throws.
PackResult pack_stacked(
    std::span<const charts::Outline> islands, Rotation rotation,
    const std::function<PackResult(std::span<const charts::Outline>)>& pack_shapes,
    const std::stop_token& stop);

}  // namespace unwrapd::pack
