#pragma once
// How much a search for charts tries. Budgets are counted, never timed.

#include <cstddef>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"

namespace unwrapd::segment {

/// A smaller surface that stands for a large one while charts are sought.
struct StandIn {
  Index beyond = 0;  ///< for surfaces of more faces
  Index faces = 0;   ///< that it has
  Index finer = 0;   ///< faces of another, where this one hides too much; 0: none
};

struct SearchExtent {
  double faces = 0;        ///< that greedy merges and rounds may work on for a whole page
  std::size_t merges = 1;  ///< greedy merges, at most
  std::size_t kept = 1;    ///< of their results that are worked on, at most
  double rounds = 0;       ///< of large-neighbourhood search, at most
  double idle = 0;         ///< rounds without a gain that end it, in regions of the partition
  double packing = 1;      ///< work of a rough packing, in shares of pack::rough_fill()'s
  StandIn first = {};      ///< where it shows the bound's room, and the charts keep the bound
  StandIn second = {};     ///< where the first does not
};

SearchExtent search_extent(Effort effort);

}  // namespace unwrapd::segment
