#pragma once
// Greedy merging: neighbouring regions become one as long as their maps stay good.

#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/segment/base/join.hpp"
#include "core/segment/base/progress_estimate.hpp"

namespace unwrapd::segment {

/// Which unions are allowed, and which come first.
struct MergeSettings {
  double budget = 0;  ///< neither sum of the regions' excess rises above this
  double cap = 0;     ///< excess of one region over its area, at most, where a union adds some
  double distortion_weight = 5;  ///< of the whole budget, in borders of a whole region
  double page_area = 1;    ///< of all charts on the page: no union may need a larger page than this
  double least_fill = 0;   ///< with this share of it covered; 0: a union may have any shape
  double least_solid = 0;  ///< share of its convex hull that a large union covers, at least
  double noise = 0;        ///< share of a border's worth that is random
  int seed = 0;            ///< of the noise; equal seeds give equal noise
  Index whole = 0;         ///< regions at the front that merge with no other one of these
  Index enough = 1;        ///< merging ends at this number of regions
  bool only_kept = false;  ///< regions merge only across edges that are kept
  MapAnyhow anyhow = {};   ///< unions need no sound map (Joiner::force()); empty: they do
};

/// What a step of the search works on, reports to and stops at.
struct MergeContext {
  const SegmentationMesh& surface;
  ProgressEstimate* progress = nullptr;  ///< counts the faces that are tested; null: not counted
  FailedTrials* failures = nullptr;      ///< see TestRules; for one thread; null: none
  std::stop_token stop = {};
};

/// Regions, and the half-edges inside regions that are seams nevertheless.
struct Partition {
  std::vector<MappedRegion> regions;
  std::vector<char> open;  ///< one a half-edge of the surface, 1: not glued
};

/// Merges greedily until no allowed union is left. The same for any executor. Throws
/// Error{cancelled}.
Partition merge_regions(const MergeContext& context, const Joiner& joiner, Partition from,
                        const MergeSettings& settings, Executor& executor);

/// The region of each face.
std::vector<Index> owners(const SegmentationMesh& surface, const Partition& partition);

}  // namespace unwrapd::segment
