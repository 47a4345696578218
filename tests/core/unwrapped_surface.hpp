#pragma once
// One surface unwrapped on one thread.

#include <vector>

#include "core/unwrap.hpp"

namespace unwrapd {

inline Unwrapped unwrapped_surface(const Surface& surface, const UnwrapOptions& options) {
  SerialExecutor serial;
  return unwrap(std::vector{surface}, options, {}, serial);
}

}  // namespace unwrapd
