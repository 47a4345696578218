#include "server/work/mesh_analysis.hpp"

#include "api/error_table.hpp"
#include "api/report.hpp"
#include "core/base/shared_cache.hpp"
#include "core/pipeline/analyse.hpp"
#include "server/work/run_job.hpp"

namespace unwrapd::server::work {
namespace {

api::Json analysis_json(const RenderingInput& mesh, std::size_t memory_bytes,
                        const api::Limits& limits) {
  const asset::Asset asset =
      asset::read(mesh.asset, read_limits(mesh.record, limits, memory_bytes));
  check_memory(pipeline::job_bytes(asset.surfaces()), memory_bytes);
  const pipeline::InputAnalysis analysis = pipeline::analyse(asset.surfaces(), mesh.asset.stop);
  api::Json json = {{"format", asset::format_name(asset.format())}};
  json.update(api::to_json(analysis.input, analysis.repairs, asset.repairs()));
  return json;
}

}  // namespace

std::string mesh_analysis(const RenderingInput& mesh, std::size_t memory_bytes,
                          const api::Limits& limits) {
  api::Json json;
  try {
    json = {{"analysis", analysis_json(mesh, memory_bytes, limits)}};
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    json = {{"problem", api::problem(error)}};
  }
  return json.dump(-1, ' ', false, api::Json::error_handler_t::replace);
}

}  // namespace unwrapd::server::work
