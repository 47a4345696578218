// Over-segment by normals, then merge with ARAP as the judge.
//
// The patches to begin with shall use but a part of the distortion that is allowed, so that merging
// has something to spend: their flatness is tightened until they do. A patch that has no sound map
// (a tube, a fold) is clustered again by itself, ever more tightly; single triangles always have
// one, so this ends.
#include "core/segment/segment.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/segment/cluster.hpp"
#include "core/segment/excess_steps.hpp"
#include "core/segment/labels.hpp"
#include "core/segment/partition_cost.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kFlatness = 0.06;  // mean 1 - cosine within a patch; half for each next round
constexpr int kFlatnessRounds = 6;
constexpr double kShareOfPatches = 0.3;  // of the budget, that patches may use before they merge
constexpr double kRefinement = 0.3;      // of flatness, each time a patch has no sound map
constexpr int kRefinements = 4;          // then the patch falls into its triangles
constexpr int kSmoothingPasses = 3;
constexpr double kSmoothCosine = 0.9;  // smoothing of borders does not reach around sharper edges
constexpr double kMargin = 0.97;  // of what is allowed: solving on may shift some between the two
constexpr double kAnyExcess = 1e6, kFarPrice = 10;  // beyond the bound, for a number of regions
constexpr double kPatchesShare = 0.1, kFacesOfPatches = 6;  // of the work; for each face
constexpr std::size_t kPatchesAtOnce = 16;                  // then progress is told
constexpr double kFacesOfQuick = 20, kQuickPrice = 1;
constexpr double kCapOfOnePatch = 4;  // in shares of what is allowed of all

/// How the work is watched and done.
struct Work {
  const std::stop_token& stop;
  ProgressEstimate& progress;
  Executor& executor;
};

ExcessDistortion total_of(std::span<const MappedRegion> patches) {
  ExcessDistortion total;
  for (const MappedRegion& patch : patches) total += patch.excess;
  return total;
}

/// The faces of each label with a map of their own, from their projection.
std::vector<MappedRegion> map_patches(const SegmentationMesh& surface, std::vector<Index>& label,
                                      const Work& work) {
  std::vector<std::vector<Index>> faces = faces_by_label(label, renumber(label));
  std::vector<MappedRegion> patches(faces.size());
  const auto map = [&](std::size_t k) {
    MappedRegion& patch = patches[k];
    patch.region.faces = std::move(faces[k]);
    patch.region.uv = projected(surface, patch.region.faces);
    const TestRules rules{.most_excess = std::numeric_limits<double>::infinity(),
                          .stop = work.stop};
    const TestResult result = test_parameterization(surface, {}, rules, patch.region);
    patch.excess = result.excess;
    patch.is_sound = result.verdict == Verdict::sound;
    for (const Index t : patch.region.faces) patch.area += surface.area(t);
  };
  for (std::size_t first = 0; first < patches.size(); first += kPatchesAtOnce) {
    const std::size_t count = std::min(kPatchesAtOnce, patches.size() - first);
    work.executor.for_each_block(static_cast<int>(count),
                                 [&](int block) { map(first + static_cast<std::size_t>(block)); });
    throw_if_cancelled(work.stop);
    std::size_t mapped = 0;
    for (std::size_t k = first; k < first + count; ++k) mapped += patches[k].region.faces.size();
    work.progress.add(mapped);
  }
  return patches;
}

/// Patches without a sound map fall into smaller ones: those of `finer` labels.
void split_unsound(const SegmentationMesh& surface, std::span<const MappedRegion> patches,
                   std::span<const Index> finer, std::vector<Index>& label) {
  const auto face_count = static_cast<Index>(label.size());
  for (const MappedRegion& patch : patches) {
    if (patch.is_sound) continue;
    for (const Index t : patch.region.faces) label[t] = face_count + finer[t];
  }
  separate_labels(surface.halfedges, label);
}

std::vector<MappedRegion> sound_patches(const SegmentationMesh& surface, double flatness,
                                        std::vector<Index> label, const Work& work) {
  std::vector<MappedRegion> patches = map_patches(surface, label, work);
  const auto is_sound = [](const MappedRegion& patch) { return patch.is_sound; };
  for (int k = 0; k <= kRefinements && !std::ranges::all_of(patches, is_sound); ++k) {
    flatness *= kRefinement;
    std::vector<Index> finer(label.size());
    std::iota(finer.begin(), finer.end(), 0);
    if (k < kRefinements) finer = cluster_faces(surface, surface.normal, flatness, work.stop);
    split_unsound(surface, patches, finer, label);
    patches = map_patches(surface, label, work);
  }
  return patches;
}

std::vector<MappedRegion> over_segment(const SegmentationMesh& surface, double excess,
                                       const Work& work) {
  work.progress.begin(kPatchesShare, kFacesOfPatches * surface.face_count());
  const double allowed = kShareOfPatches * excess;
  double flatness = kFlatness;
  for (int round = 1;; ++round, flatness /= 2) {
    std::vector<Index> label = cluster_faces(surface, surface.normal, flatness, work.stop);
    smooth_labels(surface, kSmoothingPasses, kSmoothCosine, label);
    std::vector<MappedRegion> patches = sound_patches(surface, flatness, label, work);
    if (round == kFlatnessRounds || total_of(patches).worst() <= allowed) return patches;
  }
}

MergeRules merge_rules(const SegmentRules& rules, double excess, ProgressEstimate& progress) {
  const double budget = kMargin * excess;
  MergeRules merging{.budget = budget, .cap = kCapOfOnePatch * budget, .stop = rules.stop};
  merging.page_area = rules.page_area;
  merging.progress = &progress;
  return merging;
}

/// Merged on however distorted, to so many patches where maps allow it.
Partition limited(const SegmentationMesh& surface, Partition partition, const SegmentRules& rules,
                  Executor& executor) {
  if (partition.patches.size() <= static_cast<std::size_t>(rules.most_regions)) return partition;
  const MergeRules merging{.budget = kAnyExcess,
                           .cap = kAnyExcess,
                           .distortion_weight = kFarPrice * kAnyExcess,
                           .enough = rules.most_regions,
                           .stop = rules.stop};
  return merge_patches(Joiner(surface), surface, std::move(partition), merging, executor);
}

}  // namespace

SurfaceSegmentation::SurfaceSegmentation(const SegmentationMesh& surface, SegmentRules rules,
                                         std::size_t steps, Executor& executor)
    : surface_(surface),
      rules_(std::move(rules)),
      steps_(steps),
      executor_(executor),
      effort_([this](double share) {
        if (rules_.on_progress) rules_.on_progress(stage_, share);
      }) {}

Segments SurfaceSegmentation::first(double excess) {
  const Work work{rules_.stop, effort_, executor_};
  patches_ = {over_segment(surface_, excess, work), std::vector<char>(surface_.length.size(), 0)};
  stage_ = Stage::merge;
  MergeRules merging = merge_rules(rules_, excess, effort_);
  if (rules_.is_quick) {
    effort_.begin(1, kFacesOfQuick * surface_.face_count());
    merging.distortion_weight = kQuickPrice;
    return segments_of(
        merge_patches(Joiner(surface_), surface_, std::move(patches_), merging, executor_));
  }
  return segments_of(merge_.emplace(surface_, patches_, merging, steps_, executor_).first());
}

std::optional<Segments> SurfaceSegmentation::loosened(double excess) {
  if (!merge_->loosen(kMargin * excess)) return std::nullopt;
  return segments_of(merge_->best());
}

Segments SurfaceSegmentation::segments_of(Partition best) const {
  best = limited(surface_, std::move(best), rules_, executor_);
  Segments segments{.regions = {},
                    .open = {},
                    .excess = total_of(best.patches),
                    .seam_length = seam_length(surface_, best)};
  segments.open = std::move(best.open);
  for (MappedRegion& patch : best.patches) segments.regions.push_back(std::move(patch.region));
  return segments;
}

bool is_better(const SeamsOfCharts& one, const SeamsOfCharts& other, Index most) {
  const auto beyond = [&](const SeamsOfCharts& own) {
    return std::max(own.charts, static_cast<std::size_t>(most));
  };
  if (beyond(one) != beyond(other)) return beyond(one) < beyond(other);
  return one.length < other.length;
}

Segments segment(const SegmentationMesh& surface, const SegmentRules& rules, Executor& executor) {
  const std::vector<double> steps = excess_steps(rules.max_distortion);
  SurfaceSegmentation segmentation(surface, rules, steps.size() - 1, executor);
  const auto seams = [](const Segments& own) {
    return SeamsOfCharts{own.regions.size(), own.seam_length};
  };
  Segments best = segmentation.first(steps.front());
  for (const double excess : std::span(steps).subspan(1)) {
    std::optional<Segments> next = segmentation.loosened(excess);
    if (next && is_better(seams(*next), seams(best), rules.most_regions)) best = std::move(*next);
  }
  return best;
}

}  // namespace unwrapd::segment
