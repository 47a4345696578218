#pragma once
// Which options determine that a component stays one chart.

#include "core/types/options.hpp"

namespace unwrapd {

/// Whether longest boundaries get the shape that is asked for: other methods choose their own.
inline bool shapes_boundary(const UnwrapOptions& options) {
  return options.boundary != BoundaryShape::free && can_hold(options.method);
}

/// Whether each component stays one chart: constraints and boundary shapes are about all of it.
inline bool keeps_whole(const UnwrapOptions& options) {
  return !options.constraints.empty() || shapes_boundary(options);
}

}  // namespace unwrapd
