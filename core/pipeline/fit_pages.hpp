#pragma once
// The size of the page that islands need at a given density.

#include <functional>
#include <span>

#include "core/charts/outline.hpp"
#include "core/pack/pack.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

struct FittedPages {
  pack::PackResult packed;
  PageSize page;
};

/// Packs all islands on a page.
using PackOnce = std::function<pack::PackResult(const pack::PageOptions& page)>;

/// The smallest square page that the search finds for the islands at page.packing.texels_per_unit,
/// with their padding: a multiple of four texels, or a power of two, at least kMinResolution and as
/// large as the padding needs. Further pages are taken only beyond kMaxResolution, no more than
/// page.packing.max_pages. page.resolution has no effect. Throws what pack throws, and
/// Error{does_not_fit}.
FittedPages fit_pages(std::span<const charts::Outline> islands, pack::PageOptions page, PageFit fit,
                      const PackOnce& pack);

}  // namespace unwrapd::pipeline
