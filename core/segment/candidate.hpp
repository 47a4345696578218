#pragma once
// A partition that competes with others.

#include "core/segment/failed_trials.hpp"
#include "core/segment/partition_cost.hpp"

namespace unwrapd::segment {

/// A partition and what it costs.
struct Candidate {
  Partition partition = {};
  PartitionCost cost = {};
  double tried_faces = 0;      ///< to come to it; see Effort
  FailedTrials failures = {};  ///< on the way to it
};

}  // namespace unwrapd::segment
