#include "core/pipeline/layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace unwrapd::pipeline {
namespace {

/// Three charts, of which the guarantee made two of one, for overlaps or for flips.
Layout with_split(Index overlaps, std::optional<Note> note = {}) {
  const auto all = std::make_shared<Prepared>();
  all->note = std::move(note);
  Layout layout;
  layout.all = all;
  layout.report.charts.resize(3);
  for (std::size_t k = 0; k < 2; ++k) layout.report.charts[k].mending.parts = 2;
  layout.report.charts[0].mending.overlaps = overlaps;
  return layout;
}

std::ptrdiff_t exceeded_count(Layout layout, std::optional<int> most) {
  UnwrapOptions options;
  options.max_charts = most;
  note_new_maps(layout, options);
  return std::ranges::count(layout.report.notes, NoteCode::charts_exceeded, &Note::code);
}

TEST(Layout, TellsWhereSplitsLeaveMoreChartsThanAsked) {
  EXPECT_EQ(exceeded_count(with_split(7), 2), 1);
  EXPECT_EQ(exceeded_count(with_split(0), 2), 1);
  EXPECT_EQ(exceeded_count(with_split(7), 3), 0);
  EXPECT_EQ(exceeded_count(with_split(7), {}), 0);
  EXPECT_EQ(exceeded_count(with_split(7, Note{NoteCode::surface_noisy, ""}), 2), 1);
  EXPECT_EQ(exceeded_count(with_split(7, Note{NoteCode::charts_exceeded, ""}), 2), 0);  // told
}

}  // namespace
}  // namespace unwrapd::pipeline
