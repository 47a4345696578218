#include "core/pipeline/packed_map.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "core/charts/packed_chart.hpp"

namespace unwrapd::pipeline {
namespace {

void require_sound(bool is_sound) {
  if (!is_sound) throw Error(ErrorCode::internal, "A packed map is unsound.");
}

double next_number(ByteUnpacker& bytes) {
  const auto number = bytes.next<double>();
  require_sound(std::isfinite(number));
  return number;
}

Index next_count(ByteUnpacker& bytes) {
  const auto count = bytes.next<Index>();
  require_sound(count >= 0);
  return count;
}

template <class Enum>
Enum next_of(ByteUnpacker& bytes, Enum last) {
  const auto number = bytes.next<std::uint8_t>();
  require_sound(number <= static_cast<std::uint8_t>(last));
  return static_cast<Enum>(number);
}

template <class Value>
void add_optional(BytePacker& bytes, const std::optional<Value>& value) {
  bytes.add(std::uint8_t{value.has_value()}).add(value.value_or(Value{}));
}

template <class Value>
std::optional<Value> next_optional(ByteUnpacker& bytes) {
  const bool is_there = bytes.next<std::uint8_t>() != 0;
  const auto value = bytes.next<Value>();
  return is_there ? std::optional(value) : std::nullopt;
}

void add(BytePacker& bytes, const ChartReport& report) {
  const auto& [surface, faces, vertices, boundaries, area, seam_length, distortion, iterations,
               stop_reason, energy, overlaps, mending] = report;
  bytes.add(surface).add(faces).add(vertices).add(boundaries).add(area).add(seam_length);
  const auto& [angle, area_distortion, stretch, flipped, degenerate] = distortion;
  bytes.add(angle).add(area_distortion).add(stretch).add(flipped).add(degenerate);
  bytes.add(iterations).add(static_cast<std::uint8_t>(stop_reason)).add_list(energy);
  add_optional(bytes, overlaps);
  const auto& [flips, parted, energy_rise, virtual_boundary, parts] = mending;
  bytes.add(flips).add(parted).add(energy_rise).add(std::uint8_t{virtual_boundary}).add(parts);
}

ChartReport next_report(ByteUnpacker& bytes) {
  ChartReport report;
  for (Index* count : {&report.surface, &report.faces, &report.vertices, &report.boundaries})
    *count = next_count(bytes);
  report.area = next_number(bytes);
  report.seam_length = next_number(bytes);
  Distortion& distortion = report.distortion;
  for (double* figure : {&distortion.angle, &distortion.area, &distortion.stretch})
    *figure = next_number(bytes);
  distortion.flipped = next_count(bytes);
  distortion.degenerate = next_count(bytes);
  report.iterations = next_count(bytes);
  report.stop_reason = next_of(bytes, StopReason::neighbour);
  report.energy = bytes.next_list<double>();
  require_sound(!report.energy.empty());
  report.overlaps = next_optional<Index>(bytes);
  Mending& mending = report.mending;
  mending.flips = next_count(bytes);
  mending.overlaps = next_count(bytes);
  mending.energy_rise = bytes.next<double>();
  mending.virtual_boundary = bytes.next<std::uint8_t>() != 0;
  mending.parts = next_count(bytes);
  return report;
}

void add(BytePacker& bytes, const ChartEvent& event) {
  bytes.add(static_cast<std::uint8_t>(event.kind)).add(static_cast<std::uint8_t>(event.stage));
  add_optional(bytes, event.lambda);
  const IterationEvent& own = event.iteration;
  bytes.add(own.iteration).add(own.energy).add(own.rel_change).add(own.angle).add(own.area);
  bytes.add(own.flipped);
}

ChartEvent next_event(ByteUnpacker& bytes) {
  ChartEvent event;
  event.kind = next_of(bytes, ChartEvent::Kind::end_run);
  event.stage = next_of(bytes, Stage::write);
  event.lambda = next_optional<double>(bytes);
  IterationEvent& own = event.iteration;
  own.iteration = next_count(bytes);
  for (double* figure : {&own.energy, &own.rel_change, &own.angle, &own.area})
    *figure = bytes.next<double>();
  own.flipped = next_count(bytes);
  return event;
}

/// The parts of a chart under one map.
std::vector<MappedChart> next_parts(ByteUnpacker& bytes, const ChartJob& job) {
  std::vector<MappedChart> parts;
  const bool is_whole = bytes.next<std::uint8_t>() != 0;
  charts::PartReader reader(*job.chart);
  const auto count = bytes.next<std::uint32_t>();
  require_sound(is_whole ? count == 1 : count > 1);
  for (std::uint32_t k = 0; k < count; ++k) {
    MappedChart part;
    part.chart = is_whole ? job.chart : std::make_shared<const charts::Chart>(reader.next(bytes));
    const std::size_t vertices = part.chart->mesh.positions.size();
    part.uv = charts::next_map(bytes, vertices);
    part.constrained = bytes.next_list<char>();
    require_sound(part.constrained.size() == vertices || part.constrained.empty());
    part.report = next_report(bytes);
    parts.push_back(std::move(part));
  }
  if (!is_whole) reader.require_all();
  return parts;
}

}  // namespace

void pack(BytePacker& bytes, const ChartJob& job, const ToldMaps& told) {
  for (const std::vector<MappedChart>& parts : told.maps) {
    const bool is_whole = parts.size() == 1 && parts.front().chart == job.chart;
    bytes.add(std::uint8_t{is_whole}).add(static_cast<std::uint32_t>(parts.size()));
    for (const auto& [chart, uv, constrained, report] : parts) {
      if (!is_whole) charts::pack(bytes, *chart);
      bytes.add_list(uv).add_list(constrained);
      add(bytes, report);
    }
  }
  bytes.add(static_cast<std::uint64_t>(told.events.size()));
  for (const ChartEvent& event : told.events) add(bytes, event);
}

ToldMaps unpack_maps(ByteUnpacker& bytes, const ChartJob& job, std::size_t map_count) {
  ToldMaps told;
  for (std::size_t k = 0; k < map_count; ++k) told.maps.push_back(next_parts(bytes, job));
  for (auto left = bytes.next<std::uint64_t>(); left > 0; --left)
    told.events.push_back(next_event(bytes));
  return told;
}

}  // namespace unwrapd::pipeline
