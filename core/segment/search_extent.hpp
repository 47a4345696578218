#pragma once
// How much a search for charts tries. Budgets are counted, never timed.

#include <cstddef>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"

namespace unwrapd::segment {

struct SearchExtent {
  double faces = 0;        ///< that greedy merges and rounds may work on for a whole page
  std::size_t merges = 1;  ///< greedy merges, at most
  std::size_t kept = 1;    ///< of their results that are worked on, at most
  double rounds = 0;       ///< of large-neighbourhood search, at most
  double idle = 0;         ///< rounds without a gain that end it, in regions of the partition
  double packing = 1;      ///< work of a rough packing, in shares of pack::rough_fill()'s
  Index most_faces = 0;    ///< beyond, a smaller surface stands for a component
  Index coarse_faces = 0;  ///< that this has
};

SearchExtent search_extent(Effort effort);

}  // namespace unwrapd::segment
