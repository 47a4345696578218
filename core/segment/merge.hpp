#pragma once
// Neighbouring regions made one, greedily, as long as their maps stay good.

#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/segment/join.hpp"
#include "core/segment/progress_estimate.hpp"

namespace unwrapd::segment {

struct MergeRules {
  double budget = 0;  ///< neither sum of the patches' excess rises above this
  double cap = 0;     ///< excess of one patch over its area, at most, where a union adds some
  double distortion_weight = 5;  ///< of all the budget, in borders of a whole patch
  double page_area = 1;    ///< of all that comes onto the page: no union shall need more of it than
  double least_fill = 0;   ///< this share allows; 0: as wide as it likes
  double least_solid = 0;  ///< share of its convex hull that a large union covers, at least
  double noise = 0;        ///< share of borders' worth that is drawn by lot
  int seed = 0;            ///< which of the draws; each is the same for everybody
  Index whole = 0;         ///< so many patches at the front merge only by way of others
  Index enough = 1;        ///< ends when there are no more patches than this
  ProgressEstimate* progress = nullptr;  ///< told of the faces that are tried; null: nobody
  FailedTrials* memory = nullptr;        ///< see TestRules; with an executor of one thread alone
  std::stop_token stop = {};
};

/// Regions, and the half-edges inside of them that are seams all the same.
struct Partition {
  std::vector<MappedRegion> patches;
  std::vector<char> open;  ///< one a half-edge of the surface, 1: not glued
};

/// The same for any executor. Throws Error{cancelled}.
Partition merge_patches(const Joiner& joiner, const SegmentationMesh& surface, Partition from,
                        const MergeRules& rules, Executor& executor);

}  // namespace unwrapd::segment
