#include "server/work/rendering.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "api/error_table.hpp"
#include "api/options.hpp"
#include "api/report.hpp"
#include "api/result.hpp"
#include "core/base/shared_cache.hpp"
#include "core/figure/layout_image.hpp"
#include "core/figure/layout_svg.hpp"
#include "core/figure/preview.hpp"
#include "core/pipeline/analyse.hpp"
#include "server/work/png_file.hpp"
#include "server/work/run_job.hpp"
#include "server/work/uv_file.hpp"

namespace unwrapd::server::work {
namespace {

using Surfaces = std::vector<UnwrappedSurface>;

/// Stretches UVs to the shape of the page, whose longer side becomes 1. Returns the sides of the
/// page; of the square, where UVs lie beyond the page: then it has no margins.
Vec2 shape_page(const PageSize& page, Surfaces& unwrapped) {
  constexpr double kSlack = 1e-6;
  const Vec2 sides = Vec2(page.width, page.height) / std::max(page.width, page.height);
  if (sides == Vec2::Ones()) return sides;
  bool is_beyond = false;
  for (UnwrappedSurface& surface : unwrapped)
    for (Vec2& uv : surface.uv) {
      is_beyond = is_beyond || uv.minCoeff() < -kSlack || uv.maxCoeff() > 1 + kSlack;
      uv = uv.cwiseProduct(sides);
    }
  return is_beyond ? Vec2(Vec2::Ones()) : sides;
}

std::string draw(const Picture& picture, const asset::Asset& asset, const PageSize& page,
                 Surfaces unwrapped, const std::stop_token& stop) {
  const figure::LayoutLook look(picture.colouring, shape_page(page, unwrapped));
  switch (picture.kind) {
    case PictureKind::layout_svg:
      return figure::layout_svg(asset.surfaces(), unwrapped, look, stop);
    case PictureKind::layout_png:
      return encode_png(
          figure::layout_image(asset.surfaces(), unwrapped, look, picture.size, stop));
    case PictureKind::preview_png:
      return encode_png(figure::preview(asset.surfaces(), unwrapped, picture.size, stop));
  }
  return {};
}

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

/// What a stored mesh is, as JSON: {"analysis": {...}}, or {"problem": {...}}, the error with which
/// a job on this mesh with default options would begin. memory_bytes: what a job may take. Throws
/// Error{cancelled}.
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

}  // namespace

std::string render(const Rendering& rendering, const RenderingInput& input,
                   const api::Limits& limits) {
  if (rendering.analysis) return mesh_analysis(input, *rendering.analysis, limits);
  const api::JobOptions options = api::parse_stored_options(input.record.options);
  const asset::Asset asset =
      asset::read(input.asset, read_limits(input.record, limits), options.asset);
  Surfaces unwrapped = decode_uvs(input.uvs);
  if (rendering.picture)
    return draw(*rendering.picture, asset, options.unwrap.page_size(), std::move(unwrapped),
                input.asset.stop);
  if (rendering.format) return asset::write(asset, unwrapped, *rendering.format);
  return api::result_json(api::Json::parse(input.report), asset.surfaces(), unwrapped);
}

}  // namespace unwrapd::server::work
