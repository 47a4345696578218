#pragma once
// The report of a job as JSON: what came in, what was repaired, how good every chart is.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "api/json.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/file_repair.hpp"
#include "core/types/report.hpp"

namespace unwrapd::api {

/// What core does not know of a job.
struct ReportContext {
  std::string sha256 = {};   ///< of the request's mesh document, lowercase hex
  std::int64_t bytes = 0;    ///< of the mesh document and its buffers
  std::string version = {};  ///< of the solver: "0.1.0"
  /// Milliseconds by stage: queue, read, setup, factor, solve, untangle, measure, pack, write,
  /// total.
  std::map<std::string, double> timings_ms = {};
  std::vector<FileRepair> file_repairs = {};  ///< before core's own
  std::vector<std::string> notes = {};        ///< beside core's own (see JobOptions::notes)
  std::optional<std::vector<VertexMap>> vertex_maps = {};  ///< where the report shall have them
};

/// The report, every figure finite: an infinite one is given as the largest double.
Json to_json(const Report& report, const ReportContext& context);

/// What came in and what would be repaired, of a mesh that is only looked at: the counts of a
/// report's `input`, and `repairs`.
Json to_json(const InputReport& input, const std::vector<Repair>& repairs,
             std::span<const FileRepair> file_repairs = {});

/// The totals alone, for a header: charts, distortion, seam_length, fill, texel_density.
Json totals_json(const Report& report);

}  // namespace unwrapd::api
