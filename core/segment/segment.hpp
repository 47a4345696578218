#pragma once
// Splits a surface of any genus into few regions that ARAP flattens with little distortion.

#include <functional>
#include <limits>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/base/executor.hpp"
#include "core/segment/base/segmentation_mesh.hpp"
#include "core/segment/search/merge_search.hpp"
#include "core/types/options.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::segment {

/// Of the excess allowed: solving on may shift some between D_angle and D_area.
inline constexpr double kMarginOfExcess = 0.97;

/// The excess of one region over its area, at most, in shares of what is allowed of all.
inline constexpr double kMostOfOneRegion = 4;

/// Is told the share of the work that is done, [0, 1]; may be empty.
using OnProgress = std::function<void(Stage, double)>;

/// Tells `whole` of a part of its work, from one share of it to another.
OnProgress part_of_progress(OnProgress whole, double begin, double end);
/// The share that was told stays where a search begins anew.
OnProgress progress_without_steps_back(OnProgress whole);

struct SegmentRules {
  double max_distortion = kDefaultDistortion;  ///< of all regions together, D_angle and D_area; > 2
  Index most_regions = std::numeric_limits<Index>::max();  ///< reached at any distortion
  double page_area = 1;  ///< of all that lies on one page with this surface, in units of its area
  Effort effort = Effort::balanced;
  bool is_quick = false;  ///< one merge, no search for the best
  OnProgress on_progress = {};
  std::stop_token stop = {};
};

struct Segments {
  std::vector<Region> regions;
  std::vector<char> open;        ///< one a half-edge of the surface, 1: a seam inside a region
  ExcessDistortion excess = {};  ///< of all maps, over the surface's area
  double seam_length = 0;        ///< area of the surface: 1
};

/// What is compared of the results of several bounds.
struct SeamsOfCharts {
  std::size_t charts = 0;
  double length = 0;
};

SeamsOfCharts seams_of(const Segments& segments);

/// Shorter seams are better; first of all, fewer of the charts beyond `most` are.
bool is_better(const SeamsOfCharts& one, const SeamsOfCharts& other, Index most);

/// A surface segmented for one bound, and from there for looser ones. Every face is in exactly one
/// region; each region is a disk (holes allowed) whose map has no flip and no overlap, unless it is
/// forced (Region::is_forced). In the worst case regions are single triangles. The same for any
/// executor, and for the surface of a mesh that was moved or scaled. All throw Error{cancelled}.
class SurfaceSegmentation {
 public:
  /// steps: how often loosen() is going to be called. surface and executor must outlive this.
  SurfaceSegmentation(const SegmentationMesh& surface, SegmentRules rules, std::size_t steps,
                      Executor& executor);
  SurfaceSegmentation(const SurfaceSegmentation&) = delete;
  SurfaceSegmentation& operator=(const SurfaceSegmentation&) = delete;

  /// The regions for this excess over 2, whatever the rules' bound. Called first, and once.
  Segments first(double excess);

  /// Those for a larger excess than the last one; nothing where the same partition is the best.
  /// Another one has shorter seams, unless there are more regions than the rules allow: either is
  /// then merged further.
  std::optional<Segments> loosen(double excess);

  /// The excess that keeping edges (SegmentationMesh::kept) adds to any bound.
  [[nodiscard]] double forced_excess() const { return forced_; }

 private:
  void merge_across_kept_edges();
  [[nodiscard]] MergeSettings settings_for(double excess) const;
  [[nodiscard]] Segments merge_quickly(const MergeSettings& settings);
  [[nodiscard]] search::Candidate finish(std::vector<search::Candidate> all);
  [[nodiscard]] Segments segments_of(Partition best) const;

  const SegmentationMesh& surface_;
  SegmentRules rules_;
  std::size_t steps_;
  Executor& executor_;
  Stage stage_ = Stage::segment;
  ProgressEstimate progress_;
  MergeContext context_;
  Partition partition_;
  std::optional<search::MergeSearch> search_;
  std::vector<search::Candidate> competing_;  ///< after large-neighbourhood search
  search::Candidate best_;
  bool is_priced_ = false;  ///< best_ is
  double forced_ = 0;       ///< see forced_excess()
};

/// The excess over 2 of each bound on the way to max_distortion, ascending (ADR 0039). The search
/// for the first starts anew, the others continue from the one before. A max_distortion below
/// kDefaultDistortion is the only step; above it all bounds share their steps, as far as they go.
/// Effort::fast takes fewer of them.
std::vector<double> excess_steps(double max_distortion, Effort effort);

/// The bound of the step before the last one; empty where there is only one.
std::optional<double> tighter_bound(double max_distortion, Effort effort);

/// The regions for the rules' bound: of those of all steps up to it (excess_steps()), the ones with
/// the shortest seams. Throws Error{cancelled}.
Segments segment(const SegmentationMesh& surface, const SegmentRules& rules, Executor& executor);

}  // namespace unwrapd::segment
