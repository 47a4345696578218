#pragma once
// Outlines to pack.

#include "core/atlas/outline.hpp"

namespace unwrapd::shapes {

inline Outline polygon(const UvMap& points) {
  Outline outline;
  for (std::size_t k = 0; k < points.size(); ++k)
    outline.push_back({points[k], points[(k + 1) % points.size()]});
  return outline;
}

}  // namespace unwrapd::shapes
