#pragma once
// The report of a job as JSON: the input, its repairs, and the quality of every chart.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/json.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/file_repair.hpp"
#include "core/types/note.hpp"
#include "core/types/report.hpp"

namespace unwrapd::api {

/// The parts of a report that core does not know.
struct ReportContext {
  std::string sha256 = {};   ///< of the request's mesh document, lowercase hex
  std::int64_t bytes = 0;    ///< of the mesh document and its buffers
  std::string version = {};  ///< of the solver: "0.1.0"
  /// Milliseconds by stage: queue, read, setup, factor, solve, untangle, measure, pack, write,
  /// total.
  std::map<std::string, double> timings_ms = {};
  std::vector<FileRepair> file_repairs = {};  ///< listed before core's own
  std::vector<Note> notes = {};               ///< listed beside core's own
  Json options = Json::object();              ///< of the job, as resolved
  int texcoord = 0;                           ///< n of the set TEXCOORD_n that is written
  std::optional<std::vector<VertexMap>> vertex_maps = {};  ///< set if the report shall have them
};

/// The name of a code on the wire, and back.
std::string_view code_name(NoteCode code);
std::optional<NoteCode> note_code_named(std::string_view name);
Json to_json(const Note& note);

/// The notes of a report's JSON text, whose other members are not kept in memory. Throws
/// Error{storage_corrupt} for what is no report.
std::vector<Note> notes_of_report(std::string_view text);

/// The report with finite numbers; an infinite one becomes the largest double.
Json to_json(const Report& report, const ReportContext& context);

/// The analysis of a mesh without a job: the counts of a report's `input`, and the `repairs` that a
/// job would make.
Json to_json(const InputReport& input, const std::vector<Repair>& repairs,
             std::span<const FileRepair> file_repairs = {});

/// Only the totals, for a header: charts, distortion, overlaps, seam_length, fill, texel_density,
/// texcoord, and the codes of the notes.
Json totals_json(const Report& report, const ReportContext& context);

}  // namespace unwrapd::api
