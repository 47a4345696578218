#pragma once
// A partition that competes with others.

#include "core/segment/partition_cost.hpp"
#include "core/segment/trial_memory.hpp"

namespace unwrapd {

/// A partition and what it costs.
struct Candidate {
  Partition partition = {};
  PartitionCost cost = {};
  double tried_faces = 0;     ///< to come to it; see Effort
  TrialMemory failures = {};  ///< on the way to it
};

}  // namespace unwrapd
