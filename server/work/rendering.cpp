#include "server/work/rendering.hpp"

#include <vector>

#include "api/options.hpp"
#include "api/result.hpp"
#include "core/figure/layout_image.hpp"
#include "core/figure/layout_svg.hpp"
#include "core/figure/preview.hpp"
#include "server/work/mesh_analysis.hpp"
#include "server/work/png_file.hpp"
#include "server/work/run_job.hpp"
#include "server/work/uv_file.hpp"

namespace unwrapd::server::work {
namespace {

using Surfaces = std::vector<UnwrappedSurface>;

std::string draw(const Picture& picture, const asset::Asset& asset, const Surfaces& unwrapped,
                 const std::stop_token& stop) {
  switch (picture.kind) {
    case PictureKind::layout_svg:
      return figure::layout_svg(asset.surfaces(), unwrapped, picture.colouring, stop);
    case PictureKind::layout_png:
      return encode_png(
          figure::layout_image(asset.surfaces(), unwrapped, picture.colouring, picture.size, stop));
    case PictureKind::preview_png:
      return encode_png(figure::preview(asset.surfaces(), unwrapped, picture.size, stop));
  }
  return {};
}

}  // namespace

std::string render(const Rendering& rendering, const RenderingInput& input,
                   const api::Limits& limits) {
  if (rendering.analysis) return mesh_analysis(input, *rendering.analysis, limits);
  const asset::Asset asset = asset::read(input.asset, read_limits(input.record, limits),
                                         api::parse_stored_options(input.record.options).asset);
  const Surfaces unwrapped = decode_uvs(input.uvs);
  if (rendering.picture) return draw(*rendering.picture, asset, unwrapped, input.asset.stop);
  if (rendering.format) return asset::write(asset, unwrapped, *rendering.format);
  return api::result_json(api::Json::parse(input.report), asset.surfaces(), unwrapped);
}

}  // namespace unwrapd::server::work
