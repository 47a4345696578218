#include "core/pipeline/place_islands.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/pack/pack_groups.hpp"
#include "core/pipeline/fit_pages.hpp"

namespace unwrapd::pipeline {
namespace {

/// A number of texels with so many digits that a reader needs.
std::string texels_text(double texels) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", texels);
  return text.data();
}

void note_padding(const pack::PackResult& packed, int asked, Report& report) {
  if (packed.padding >= asked) return;
  report.notes.push_back(
      {NoteCode::padding_reduced,
       "A padding of " + std::to_string(asked) +
           " texels around every island would take more than half of the page. The padding is " +
           texels_text(packed.padding) +
           " texels instead; ask for a larger page to have the full padding."});
}

void note_stacks(const pack::PackResult& packed, Report& report) {
  std::size_t stacked = 0;
  for (const char is_stacked : packed.is_stacked) stacked += is_stacked != 0 ? 1 : 0;
  if (stacked > 0)
    report.notes.push_back(
        {NoteCode::islands_stacked, std::to_string(stacked) + " of " +
                                        std::to_string(packed.is_stacked.size()) +
                                        " islands are stacked on another of the same shape."});
}

void note_one_group(PageGroup group, Report& report) {
  if (report.page_names.size() != 1) return;
  report.notes.push_back(
      {NoteCode::option_unused,
       group == PageGroup::mesh
           ? "The option group=mesh has no effect, because all charts are of one mesh. All objects "
             "of an OBJ are one mesh; export them as glTF to give each a page."
           : "The option group=material has no effect, because all charts have one material."});
}

/// The page of each island: that of its group, in the order in which groups occur. Throws
/// Error{does_not_fit}.
std::vector<Index> pages_of(const std::vector<std::string>& groups, Report& report) {
  std::map<std::string, Index> known;
  std::vector<Index> pages;
  for (const std::string& group : groups) {
    const auto [at, is_new] = known.try_emplace(group, static_cast<Index>(known.size()));
    if (is_new) report.page_names.push_back(group);
    pages.push_back(at->second);
  }
  if (known.size() > static_cast<std::size_t>(kMaxPages))
    throw Error(ErrorCode::does_not_fit,
                "group asks for " + std::to_string(known.size()) +
                    " pages, and there are at most " + std::to_string(kMaxPages) +
                    "; unwrap fewer of the asset's materials or primitives at once, or leave out "
                    "group",
                "/group");
  return pages;
}

FittedPages pack_islands(const IslandsToPlace& islands, const UnwrapOptions& options,
                         Executor& executor, Report& report) {
  const PageSize size = options.page_size();
  const bool is_grouped = options.packing.group != PageGroup::scene;
  const std::vector<Index> pages =
      is_grouped ? pages_of(islands.groups, report) : std::vector<Index>();
  const PackOnce pack = [&](const pack::PageOptions& page) {
    return is_grouped ? pack::pack_groups(islands.outlines, pages, page, executor)
                      : pack::pack(islands.outlines, page, executor);
  };
  const pack::PageOptions page{size.width, options.padding, options.packing, options.effort,
                               size.height};
  if (!options.finds_page() || islands.outlines.empty()) return {pack(page), size};
  return fit_pages(islands.outlines, page, options.page_fit, pack);
}

}  // namespace

void IslandsToPlace::add(charts::Outline outline, UvMap& map, std::string group) {
  outlines.push_back(std::move(outline));
  maps.push_back(&map);
  groups.push_back(std::move(group));
}

std::string group_of(const Surface& surface, Index face, PageGroup group) {
  if (group == PageGroup::mesh) return surface.name;
  if (group == PageGroup::scene || surface.materials.empty()) return {};
  return surface.materials[static_cast<std::size_t>(surface.part[static_cast<std::size_t>(face)])];
}

void place_islands(const IslandsToPlace& islands, const UnwrapOptions& options, Executor& executor,
                   Report& report) {
  const auto [packed, page] = pack_islands(islands, options, executor, report);
  double covered = 0;
  for (std::size_t k = 0; k < islands.maps.size(); ++k) {
    const pack::Placement& placement = packed.placements[k];
    for (Vec2& uv : *islands.maps[k]) uv = placement(uv);
    if (packed.is_stacked.empty() || packed.is_stacked[k] == 0)
      covered += std::abs(charts::area_of(islands.outlines[k])) * placement.scale * placement.scale;
  }
  report.pages = packed.pages;
  report.page = page;
  report.fill = covered / packed.pages / page.aspect();
  note_padding(packed, options.padding, report);
  note_stacks(packed, report);
  note_one_group(options.packing.group, report);
}

void to_uvs(UvMap& map, const PageSize& page) {
  for (Vec2& uv : map) uv.y() /= page.aspect();
}

void to_page_widths(UvMap& map, const PageSize& page) {
  for (Vec2& uv : map) uv.y() *= page.aspect();
}

}  // namespace unwrapd::pipeline
