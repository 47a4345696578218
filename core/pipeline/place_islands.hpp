#pragma once
// Islands onto their pages, and what the report says of it.

#include <string>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/outline.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::pipeline {

/// What shall be packed.
struct IslandsToPlace {
  std::vector<charts::Outline> outlines;
  std::vector<UvMap*> maps;         ///< one an island, in the units of its outline
  std::vector<std::string> groups;  ///< one an island: what it belongs to, see PageGroup

  void add(charts::Outline outline, UvMap& map, std::string group);
};

/// The group of an island, by one of its faces.
std::string group_of(const Surface& surface, Index face, PageGroup group);

/// Packs the islands; their maps become places on the page,
/// in units of its width. Fills the report's fill, pages and page, and notes what could not be had.
/// Throws Error{does_not_fit, cancelled}.
void place_islands(const IslandsToPlace& islands, const UnwrapOptions& options, Executor& executor,
                   Report& report);

/// From units of the page's width to UVs, which are 1 at its upper edge; and back.
void to_uvs(UvMap& map, const PageSize& page);
void to_page_widths(UvMap& map, const PageSize& page);

}  // namespace unwrapd::pipeline
