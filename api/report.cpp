#include "api/report.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/error.hpp"

namespace unwrapd::api {
namespace {

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 6> kStopReasons = {
    "iterations", "direct", "collapse_guard", "converged", "max_iterations", "neighbour"};
constexpr std::array<std::string_view, 3> kGuarantees = {"none", "flip_free", "bijective"};
constexpr std::array<std::string_view, 7> kRepairKinds = {"degenerate_faces_set_aside",
                                                          "duplicate_faces_set_aside",
                                                          "non_manifold_edges_split",
                                                          "cut_to_disk",
                                                          "segmented",
                                                          "vertices_welded_near",
                                                          "faces_turned"};
constexpr std::array<std::string_view, 5> kFileRepairKinds = {
    "line_ends_replaced", "empty_indices_ignored", "normals_replaced", "chunks_padded",
    "shared_nodes_kept"};

constexpr std::array<std::string_view, 28> kNoteCodes = {
    "option_unused",     "overlaps",           "distorted",
    "set_chosen",        "textures_lost",      "textures_transferred",
    "charts_exceeded",   "surface_noisy",      "chart_remapped",
    "outside_page",      "padding_reduced",    "islands_stacked",
    "faces_without_uvs", "tangents_changed",   "transform_reset",
    "materials_copied",  "morph_targets_lost", "sets_filled",
    "images_separate",   "polygons_split",     "format_changed",
    "data_dropped",      "positions_rounded",  "origin_moved",
    "lambda_repeated",   "kept_edges_cut",     "islands_tiny",
    "nodes_stretch"};
static_assert(kNoteCodes.size() == static_cast<std::size_t>(NoteCode::nodes_stretch) + 1);

/// The stages of timings_ms, in the order of a job.
constexpr std::array kTimings = {"queue", "read",     "setup",   "segment", "merge", "factor",
                                 "solve", "untangle", "measure", "pack",    "write", "total"};

Json to_json(const Distortion& distortion) {
  return {{"angle", finite(distortion.angle)},
          {"area", finite(distortion.area)},
          {"stretch", finite(distortion.stretch)},
          {"flipped", distortion.flipped},
          {"degenerate", distortion.degenerate}};
}

Json counts_json(const InputReport& input) {
  return {{"faces", input.faces},           {"vertices", input.vertices},
          {"components", input.components}, {"boundaries", input.boundaries},
          {"genus", input.genus},           {"welded", input.welded}};
}

Json to_json(const InputReport& input, const ReportContext& context) {
  Json json = {{"sha256", context.sha256}, {"bytes", context.bytes}};
  json.update(counts_json(input));
  return json;
}

Json to_json(const Repair& repair) {
  return {{"kind", kRepairKinds[static_cast<std::size_t>(repair.kind)]},
          {"surface", repair.surface},
          {"count", repair.count}};
}

/// Concerns the whole file, so that the surface is 0.
Json to_json(const FileRepair& repair) {
  return {{"kind", kFileRepairKinds[static_cast<std::size_t>(repair.kind)]},
          {"surface", 0},
          {"count", repair.count}};
}

Json to_json(const Mending& mending) {
  return {{"flips", mending.flips},
          {"overlaps", mending.overlaps},
          {"energy_rise", finite(mending.energy_rise)},
          {"virtual_boundary", mending.virtual_boundary},
          {"parts", mending.parts}};
}

Json to_json(const CurvePoint& point) {
  return {{"lambda", finite(point.lambda)},
          {"energy", finite(point.energy)},
          {"distortion", to_json(point.distortion)},
          {"iterations", point.iterations}};
}

Json to_json(const ChartReport& chart) {
  Json energy = Json::array();
  for (const double value : chart.energy) energy.push_back(finite(value));
  return {{"surface", chart.surface},
          {"faces", chart.faces},
          {"vertices", chart.vertices},
          {"boundaries", chart.boundaries},
          {"area", finite(chart.area)},
          {"seam_length", finite(chart.seam_length)},
          {"distortion", to_json(chart.distortion)},
          {"overlaps", chart.overlaps ? Json(*chart.overlaps) : Json()},
          {"mending", to_json(chart.mending)},
          {"iterations", chart.iterations},
          {"stop_reason", kStopReasons[static_cast<std::size_t>(chart.stop_reason)]},
          {"energy", std::move(energy)}};
}

Json to_json(const VertexMap& map) {
  return {{"where", map.where}, {"kept", map.kept}, {"copies", map.copies}};
}

Json notes_json(const Report& report, const ReportContext& context) {
  Json notes = Json::array();
  for (const Note& note : report.notes) notes.push_back(api::to_json(note));
  for (const Note& note : context.notes) notes.push_back(api::to_json(note));
  return notes;
}

/// Each code once, in the order of the notes.
Json note_codes_json(const Report& report, const ReportContext& context) {
  Json codes = Json::array();
  for (const std::vector<Note>* notes : {&report.notes, &context.notes})
    for (const Note& note : *notes)
      if (const Json code = code_name(note.code);
          std::find(codes.begin(), codes.end(), code) == codes.end())
        codes.push_back(code);
  return codes;
}

Json timings_json(const ReportContext& context) {
  Json timings = Json::object();
  for (const char* stage : kTimings) {
    const auto found = context.timings_ms.find(stage);
    timings[stage] = found == context.timings_ms.end() ? 0.0 : finite(found->second);
  }
  return timings;
}

template <class Item>
Json array_of(const std::vector<Item>& items) {
  Json array = Json::array();
  for (const Item& item : items) array.push_back(to_json(item));
  return array;
}

Json repairs_json(std::span<const FileRepair> file_repairs, const std::vector<Repair>& repairs) {
  Json json = Json::array();
  for (const FileRepair& repair : file_repairs) json.push_back(to_json(repair));
  for (const Repair& repair : repairs) json.push_back(to_json(repair));
  return json;
}

}  // namespace

std::string_view code_name(NoteCode code) { return kNoteCodes[static_cast<std::size_t>(code)]; }

std::optional<NoteCode> note_code_named(std::string_view name) {
  const auto found = std::ranges::find(kNoteCodes, name);
  if (found == kNoteCodes.end()) return std::nullopt;
  return static_cast<NoteCode>(found - kNoteCodes.begin());
}

Json to_json(const Note& note) { return {{"code", code_name(note.code)}, {"text", note.text}}; }

std::vector<Note> notes_of_report(std::string_view text) {
  const auto only_notes = [](int depth, Json::parse_event_t event, const Json& name) {
    return depth != 1 || event != Json::parse_event_t::key || name == "notes";
  };
  try {
    const Json report = Json::parse(text, only_notes);
    std::vector<Note> notes;
    for (const Json& note : report.at("notes"))
      notes.push_back({note_code_named(note.at("code").get<std::string>()).value(),
                       note.at("text").get<std::string>()});
    return notes;
  } catch (const Json::exception&) {
  } catch (const std::bad_optional_access&) {  // a code of no note
  }
  throw Error(ErrorCode::storage_corrupt, "A stored report is none; send the mesh again.");
}

Json to_json(const InputReport& input, const std::vector<Repair>& repairs,
             std::span<const FileRepair> file_repairs) {
  Json json = counts_json(input);
  json["repairs"] = repairs_json(file_repairs, repairs);
  return json;
}

Json totals_json(const Report& report, const ReportContext& context) {
  return {{"charts", report.charts.size()},
          {"distortion", to_json(report.distortion)},
          {"overlaps", report.overlaps ? Json(*report.overlaps) : Json()},
          {"seam_length", finite(report.seam_length)},
          {"fill", finite(report.fill)},
          {"texel_density", finite(report.texel_density)},
          {"texcoord", context.texcoord},
          {"notes", note_codes_json(report, context)}};
}

Json to_json(const Report& report, const ReportContext& context) {
  Json json = {{"input", to_json(report.input, context)},
               {"options", context.options},
               {"texcoord", context.texcoord},
               {"repairs", repairs_json(context.file_repairs, report.repairs)},
               {"notes", notes_json(report, context)},
               {"charts", array_of(report.charts)},
               {"distortion", to_json(report.distortion)},
               {"guarantee", kGuarantees[static_cast<std::size_t>(report.guarantee)]},
               {"curve", array_of(report.curve)},
               {"area", finite(report.area)},
               {"seam_length", finite(report.seam_length)},
               {"seam_ratio", finite(report.seam_ratio)},
               {"overlaps", report.overlaps ? Json(*report.overlaps) : Json()},
               {"fill", finite(report.fill)},
               {"pages", report.pages},
               {"page", {{"width", report.page.width}, {"height", report.page.height}}},
               {"page_names", report.page_names},
               {"texel_density", finite(report.texel_density)},
               {"timings_ms", timings_json(context)},
               {"solver", {{"name", "unwrapd"}, {"version", context.version}}}};
  if (context.vertex_maps) json["vertex_map"] = array_of(*context.vertex_maps);
  return json;
}

}  // namespace unwrapd::api
