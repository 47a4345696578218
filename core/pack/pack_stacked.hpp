#pragma once
// Islands of one shape on one place of the page.

#include <functional>

#include "core/pack/pack.hpp"

namespace unwrapd::pack {

/// One island of each shape is packed by pack_shapes, with the outlines of all that come to lie on
/// it. Throws Error{cancelled}, and what pack_shapes throws.
Packed pack_stacked(std::span<const charts::Outline> islands,
                    const std::function<Packed(std::span<const charts::Outline>)>& pack_shapes,
                    const std::stop_token& stop);

}  // namespace unwrapd::pack
