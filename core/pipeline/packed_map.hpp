#pragma once
// The maps of a chart as bytes, for processes that work on one job together.

#include <vector>

#include "core/base/byte_pack.hpp"
#include "core/pipeline/chart_progress.hpp"
#include "core/pipeline/parameterize_chart.hpp"

namespace unwrapd::pipeline {

/// What map_chart() makes, and what it tells meanwhile.
struct ToldMaps {
  std::vector<std::vector<MappedChart>> maps;
  std::vector<ChartEvent> events;
};

/// job: the chart that was mapped; the maps name it instead of having it.
void pack(BytePacker& bytes, const ChartJob& job, const ToldMaps& told);

/// Reads what came from outside; map_count: of the job. Throws Error{internal} where it is unsound.
ToldMaps unpack_maps(ByteUnpacker& bytes, const ChartJob& job, std::size_t map_count);

}  // namespace unwrapd::pipeline
