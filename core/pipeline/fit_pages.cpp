// How much of a page islands fill hardly depends on its size: only padding is counted in texels. So
// they are packed as large as they fit on a page of some size R. At the density asked for, that
// page is W texels wide, and its gaps are W / R times as wide as the padding: the packing is of use
// where W is at least R, and tight where it is hardly more.
#include "core/pipeline/fit_pages.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kUsualFill = 0.7;  // of the first guess
constexpr double kTight = 1.01;     // W / R that ends the search
constexpr double kLess = 0.995;     // of W, as the next R
constexpr double kMore = 1.05;      // from a page that is too small to the next
constexpr int kPackings = 3;        // at most, for one number of pages
constexpr int kSmall = 128;         // texels: padding decides, and searches take long
constexpr int kStep = 4;            // texels: blocks of compressed textures

/// Only a scene may have more pages.
[[noreturn]] void refuse(double texels, PageGroup group) {
  throw Error(ErrorCode::does_not_fit,
              "The islands at this density need pages of " +
                  std::to_string(std::llround(std::min(texels, 1e15))) + " texels a side, and " +
                  std::to_string(kMaxResolution) + " are the most; lower texels_per_unit" +
                  (group == PageGroup::scene ? ", or raise max_pages." : "."),
              "/texels_per_unit");
}

double area_of(std::span<const charts::Outline> islands) {
  double area = 0;
  for (const charts::Outline& outline : islands) area += std::abs(charts::area_of(outline));
  return area;
}

/// A packing as large as fits, and the side in texels that its pages have at the density asked for.
struct Tight {
  pack::PackResult packed;
  double width = 0;
};

class PageFitter {
 public:
  PageFitter(std::span<const charts::Outline> islands, const pack::PageOptions& page, PageFit fit,
             const PackOnce& pack)
      : islands_(islands),
        page_(page),
        fit_(fit),
        pack_(pack),
        density_(*page.packing.texels_per_unit),
        least_side_(std::max(kMinResolution, 4 * page.padding)) {
    page_.resolution = least_side_;
    page_.height.reset();
    while (pack::kept_padding(page_, islands.size()) < page.padding &&
           page_.resolution < kMaxResolution)
      page_.resolution = static_cast<int>(side_of(kMore * page_.resolution));
    least_side_ = static_cast<int>(side_of(page_.resolution));
  }

  FittedPages fitted() {
    const int most = page_.packing.max_pages;
    const double full = density_ * std::sqrt(area_of(islands_));  // side of one page without gaps
    const bool shares_pages = page_.packing.group == PageGroup::scene;
    int pages = 1;
    while (shares_pages && pages <= most && full > kMaxResolution * std::sqrt(pages)) ++pages;
    double width = full / std::sqrt(most);
    for (; pages <= most; ++pages) {
      page_.packing.max_pages = pages;
      const std::optional<Tight> tight = tightest(full / std::sqrt(pages * kUsualFill));
      if (!tight) return at_density(least_side_);
      width = tight->width;
      if (side_of(width) <= kMaxResolution) return on_page(*tight);
    }
    refuse(width, page_.packing.group);
  }

 private:
  [[nodiscard]] int clamped(double side) const {
    return static_cast<int>(
        std::clamp(std::floor(side), double(least_side_), double(kMaxResolution)));
  }

  [[nodiscard]] double side_of(double width) const {
    const double blocks = std::ceil(width / kStep) * kStep;
    const double side =
        fit_ == PageFit::power_of_two ? std::exp2(std::ceil(std::log2(width))) : blocks;
    return std::max(side, double(least_side_));
  }

  Tight packed_for(int resolution, Effort effort) const {
    pack::PageOptions page = page_;
    page.resolution = resolution;
    page.effort = effort;
    page.packing.texels_per_unit.reset();
    Tight tight{pack_(page)};
    tight.width = density_ / tight.packed.placements.front().scale;
    return tight;
  }

  /// The packing of the least width whose gaps are wide enough; none if the least page is too large
  /// for them, or if widths do not settle. The first one only shows about how large.
  std::optional<Tight> tightest(double guess) const {
    std::optional<Tight> best;
    int resolution = clamped(guess);
    resolution = clamped(kLess * packed_for(resolution, Effort::fast).width);
    for (int k = 0; k < kPackings; ++k) {
      Tight own = packed_for(resolution, resolution < kSmall ? Effort::fast : page_.effort);
      const double width = own.width;
      const bool is_of_use = width >= resolution;
      if (is_of_use && (!best || width < best->width)) best = std::move(own);
      const int next = clamped(kLess * width);
      if ((is_of_use && width <= kTight * resolution) || next == resolution) break;
      resolution = next;
    }
    return best;
  }

  /// The packing on the page: at a corner of each, where the page is larger.
  FittedPages on_page(const Tight& tight) const {
    const int side = static_cast<int>(side_of(tight.width));
    FittedPages fitted{tight.packed, {side, side}};
    const double shrink = tight.width / side;
    for (std::size_t k = 0; k < islands_.size(); ++k) {
      pack::Placement& placement = fitted.packed.placements[k];
      const double page = std::floor(placement(middle_of(islands_[k])).x());
      placement.scale *= shrink;
      placement.offset = {page + (placement.offset.x() - page) * shrink,
                          placement.offset.y() * shrink};
    }
    return fitted;
  }

  static Vec2 middle_of(const charts::Outline& outline) {
    Vec2 sum = Vec2::Zero();
    for (const auto& side : outline) sum += side[0];
    return sum / static_cast<double>(outline.size());
  }

  /// On the first page from this side on that holds the islands.
  FittedPages at_density(int side) const {
    pack::PageOptions page = page_;
    for (;; side = static_cast<int>(side_of(kMore * side))) {
      page.resolution = side;
      try {
        return {pack_(page), {side, side}};
      } catch (const Error& error) {
        if (error.code() != ErrorCode::does_not_fit || kMore * side > kMaxResolution) throw;
      }
    }
  }

  std::span<const charts::Outline> islands_;
  pack::PageOptions page_;
  PageFit fit_;
  const PackOnce& pack_;
  double density_;
  int least_side_;
};

}  // namespace

FittedPages fit_pages(std::span<const charts::Outline> islands, pack::PageOptions page, PageFit fit,
                      const PackOnce& pack) {
  return PageFitter(islands, page, fit, pack).fitted();
}

}  // namespace unwrapd::pipeline
