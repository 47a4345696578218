#include "core/pipeline/place_islands.hpp"

#include <cmath>
#include <cstddef>
#include <string>

#include "core/pack/pack.hpp"

namespace unwrapd::pipeline {
namespace {

/// By the shoelace formula over all loops.
double area_of(const charts::Outline& outline) {
  double twice = 0;
  for (const auto& [a, b] : outline) twice += a.x() * b.y() - a.y() * b.x();
  return std::abs(twice) / 2;
}

void note_padding(const pack::PackResult& packed, int asked, Report& report) {
  if (packed.padding >= asked) return;
  report.notes.push_back(
      {NoteCode::padding_reduced,
       "Padding for so many islands would fill most of the page. The padding is " +
           std::to_string(packed.padding) + " texels instead of " + std::to_string(asked) +
           "; raise resolution for the full padding."});
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

}  // namespace

void place_islands(std::span<const charts::Outline> outlines, const UnwrapOptions& options,
                   Executor& executor, std::span<UvMap* const> maps, Report& report) {
  const pack::PackResult packed = pack::pack(
      outlines, {options.resolution, options.padding, options.packing, options.effort}, executor);
  double covered = 0;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const pack::Placement& placement = packed.placements[k];
    for (Vec2& uv : *maps[k]) uv = placement(uv);
    if (packed.is_stacked.empty() || packed.is_stacked[k] == 0)
      covered += area_of(outlines[k]) * placement.scale * placement.scale;
  }
  report.pages = packed.pages;
  report.fill = covered / packed.pages;
  note_padding(packed, options.padding, report);
  note_stacks(packed, report);
}

}  // namespace unwrapd::pipeline
