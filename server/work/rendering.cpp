#include "server/work/rendering.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "api/error_table.hpp"
#include "api/options.hpp"
#include "api/report.hpp"
#include "api/result.hpp"
#include "core/base/shared_cache.hpp"
#include "core/figure/in_scene.hpp"
#include "core/figure/layout_image.hpp"
#include "core/figure/layout_svg.hpp"
#include "core/figure/preview.hpp"
#include "core/pipeline/analyse.hpp"
#include "core/pipeline/as_mapped.hpp"
#include "server/work/png_file.hpp"
#include "server/work/run_job.hpp"
#include "server/work/uv_file.hpp"

namespace unwrapd::server::work {
namespace {

using Surfaces = std::vector<UnwrappedSurface>;

/// The pages of a layout.
struct Pages {
  PageSize size;
  int count = 1;
};

/// Those of the options; where the report is there, the ones that were written.
Pages pages_of(const api::JobOptions& options, std::string_view report) {
  Pages pages{.size = options.unwrap.page_size()};
  if (report.empty()) return pages;
  const api::Json json = api::Json::parse(report);
  pages.count = json.value("pages", 1);
  if (const auto page = json.find("page"); page != json.end())
    pages.size = {.width = page->at("width"), .height = page->at("height")};
  return pages;
}

/// The longer one is 1.
Vec2 sides_of(const PageSize& page) {
  return Vec2(page.width, page.height) / std::max(page.width, page.height);
}

/// Stretches UVs to the shape of the page, and moves them so that the lower left corner of a tile
/// (UDIM, from 0) is the origin.
void bring_to_page(const Vec2& sides, int tile, Surfaces& unwrapped) {
  constexpr int kTilesARow = 10;
  const Vec2 corner(tile % kTilesARow, tile / kTilesARow);
  if (sides == Vec2::Ones() && tile == 0) return;
  for (UnwrappedSurface& surface : unwrapped)
    for (Vec2& uv : surface.uv) uv = (uv - corner).cwiseProduct(sides);
}

bool lies_beyond(const Surfaces& unwrapped) {
  constexpr double kSlack = 1e-6;
  return std::ranges::any_of(unwrapped, [](const UnwrappedSurface& surface) {
    return std::ranges::any_of(surface.uv, [](const Vec2& uv) {
      return uv.minCoeff() < -kSlack || uv.maxCoeff() > 1 + kSlack;
    });
  });
}

/// All pages in one square. Where UVs lie beyond the page, it has no margins.
figure::LayoutLook look_at_all(const Picture& picture, const Pages& pages, Surfaces& unwrapped) {
  const Vec2 sides = sides_of(pages.size);
  const bool is_beyond = sides != Vec2::Ones() && lies_beyond(unwrapped);
  bring_to_page(sides, 0, unwrapped);
  figure::LayoutLook look(picture.colouring, is_beyond ? Vec2(Vec2::Ones()) : sides);
  look.page_count = pages.count;
  look.tile = sides;
  return look;
}

figure::LayoutLook look_at_page(const Picture& picture, const Pages& pages, Surfaces& unwrapped) {
  if (picture.page > pages.count)
    throw Error(ErrorCode::invalid_option,
                "The layout has " + std::to_string(pages.count) + " pages; choose one of them.",
                "/page");
  figure::LayoutLook look(picture.colouring, sides_of(pages.size));
  look.is_cropped = true;
  bring_to_page(look.page, picture.page - 1, unwrapped);
  return look;
}

int pixels_of(const Picture& picture, const PageSize& page) {
  const int side = std::max(page.width, page.height);
  if (!picture.has_page_size) return picture.size;
  if (side <= figure::kMaxImageSize) return side;
  throw Error(ErrorCode::invalid_option,
              "The page has " + std::to_string(page.width) + " x " + std::to_string(page.height) +
                  " texels, and a picture at most 4096 pixels a side; ask for a number.",
              "/size");
}

std::string draw_layout(const Picture& picture, const asset::Asset& asset,
                        const UnwrapOptions& options, const Pages& pages, Surfaces unwrapped,
                        const std::stop_token& stop) {
  figure::LayoutLook look = picture.page > 0 ? look_at_page(picture, pages, unwrapped)
                                             : look_at_all(picture, pages, unwrapped);
  look.legend = picture.legend;
  look.background = picture.background;
  look.wireframe = picture.wireframe;
  look.numbers = picture.numbers;
  const auto repaired = pipeline::as_mapped(asset.surfaces(), options, unwrapped, stop);
  if (picture.kind == PictureKind::layout_svg)
    return figure::layout_svg(repaired.surfaces, unwrapped, look, stop);
  const int size = pixels_of(picture, pages.size);
  return encode_png(figure::layout_image(repaired.surfaces, unwrapped, look, size, stop));
}

std::string draw_preview(const Picture& picture, const asset::Asset& asset, const Pages& pages,
                         Surfaces unwrapped, const std::stop_token& stop) {
  bring_to_page(sides_of(pages.size), 0, unwrapped);
  std::span<const Surface> surfaces = asset.surfaces();
  figure::Scene scene;
  if (const auto shown = asset::shown_surfaces(asset); !shown.empty()) {
    scene = figure::in_scene(surfaces, unwrapped, shown);
    surfaces = scene.surfaces;
    unwrapped = std::move(scene.unwrapped);
  }
  return encode_png(picture.turns
                        ? figure::turntable(surfaces, unwrapped, picture.size, stop)
                        : figure::preview(surfaces, unwrapped, picture.size, picture.aspect, stop));
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
  return api::to_text(json);
}

}  // namespace

std::string render(const Rendering& rendering, const RenderingInput& input,
                   const api::Limits& limits) {
  if (rendering.analysis) return mesh_analysis(input, *rendering.analysis, limits);
  const api::JobOptions options = api::parse_stored_options(input.record.options);
  const asset::Asset asset =
      asset::read(input.asset, read_limits(input.record, limits), options.asset);
  Surfaces unwrapped = decode_uvs(input.uvs);
  if (rendering.picture) {
    const Pages pages = pages_of(options, input.report);
    const std::stop_token& stop = input.asset.stop;
    if (rendering.picture->kind == PictureKind::preview_png)
      return draw_preview(*rendering.picture, asset, pages, std::move(unwrapped), stop);
    return draw_layout(*rendering.picture, asset, options.unwrap, pages, std::move(unwrapped),
                       stop);
  }
  if (rendering.format) return asset::write(asset, unwrapped, *rendering.format);
  return api::result_json(api::Json::parse(input.report), asset.surfaces(), unwrapped);
}

}  // namespace unwrapd::server::work
