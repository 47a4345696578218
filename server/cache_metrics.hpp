#pragma once
// How often caches are asked, and what they have, as metrics.

#include "server/base/metrics.hpp"
#include "server/work/solver_cache.hpp"

namespace unwrapd::server {

/// Files that are made on request.
struct MadeFiles {
  const FileCounts* results;
  const FileCounts* pictures;
  const FileCounts* analyses;
};

/// All must outlive the metrics.
void tell_caches(Metrics& metrics, const work::SolverCache& solver, const MadeFiles& files);

}  // namespace unwrapd::server
