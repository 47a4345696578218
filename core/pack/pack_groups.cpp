// Every group is packed as large as it fits. The fullest page then determines the density of all,
// and the other groups are packed again at it. That search places one island after another, so it
// may fail where the first one did not; the density falls a little until no group fails.
#include "core/pack/pack_groups.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::pack {
namespace {

constexpr double kRounding = 1e-12;
constexpr double kSmallerDensity = 0.97;  // factor of the density after a group did not fit

class GroupPacker {
 public:
  GroupPacker(std::span<const charts::Outline> islands, std::span<const Index> group,
              const PageOptions& page, Executor& executor)
      : members_(static_cast<std::size_t>(*std::ranges::max_element(group)) + 1),
        outlines_(members_.size()),
        page_(page),
        executor_(executor) {
    for (std::size_t k = 0; k < islands.size(); ++k) {
      members_[static_cast<std::size_t>(group[k])].push_back(k);
      outlines_[static_cast<std::size_t>(group[k])].push_back(islands[k]);
    }
    page_.packing.max_pages = 1;
  }

  PackResult packed() {
    std::vector<PackResult> pages;
    for (const auto& outlines : outlines_) pages.push_back(pack(outlines, page_, executor_));
    if (!page_.packing.texels_per_unit) even_out(pages);
    return joined(pages);
  }

 private:
  static double scale_of(const PackResult& page) { return page.placements.front().scale; }

  /// Islands without extent fit at any scale, which says nothing.
  [[nodiscard]] bool has_extent(std::size_t g) const {
    return std::ranges::any_of(outlines_[g], [](const charts::Outline& island) {
      return std::ranges::any_of(island, [](const auto& side) { return side[0] != side[1]; });
    });
  }

  void even_out(std::vector<PackResult>& pages) {
    double scale = std::numeric_limits<double>::infinity();
    for (std::size_t g = 0; g < pages.size(); ++g)
      if (has_extent(g)) scale = std::min(scale, scale_of(pages[g]));
    while (!are_at(scale, pages)) scale *= kSmallerDensity;
  }

  /// Packs the groups of a larger scale again at this one; false if one does not fit.
  bool are_at(double scale, std::vector<PackResult>& pages) {
    PageOptions page = page_;
    page.packing.texels_per_unit = scale * page.resolution;
    for (std::size_t g = 0; g < pages.size(); ++g) {
      if (scale_of(pages[g]) <= scale * (1 + kRounding)) continue;
      try {
        pages[g] = pack(outlines_[g], page, executor_);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::does_not_fit) throw;
        return false;
      }
    }
    return true;
  }

  PackResult joined(const std::vector<PackResult>& pages) const {
    PackResult all;
    all.pages = static_cast<Index>(pages.size());
    all.padding = pages.front().padding;
    std::size_t count = 0;
    for (const auto& own : members_) count += own.size();
    all.placements.resize(count);
    if (page_.packing.stack_identical) all.is_stacked.resize(count);
    for (std::size_t g = 0; g < pages.size(); ++g) {
      all.padding = std::min(all.padding, pages[g].padding);
      for (std::size_t k = 0; k < members_[g].size(); ++k) {
        Placement& placement = all.placements[members_[g][k]];
        placement = pages[g].placements[k];
        placement.offset.x() += static_cast<double>(g);
        if (!all.is_stacked.empty()) all.is_stacked[members_[g][k]] = pages[g].is_stacked[k];
      }
    }
    return all;
  }

  std::vector<std::vector<std::size_t>> members_;       ///< [group]: its islands
  std::vector<std::vector<charts::Outline>> outlines_;  ///< of these
  PageOptions page_;
  Executor& executor_;
};

}  // namespace

PackResult pack_groups(std::span<const charts::Outline> islands, std::span<const Index> group,
                       const PageOptions& page, Executor& executor) {
  assert(islands.size() == group.size());
  if (islands.empty()) return {};
  return GroupPacker(islands, group, page, executor).packed();
}

}  // namespace unwrapd::pack
