#pragma once
// Files made on request: of a finished job its result in a format, or a picture of one of its maps;
// of a stored mesh its analysis. Each begins with the mesh, so each is work for a worker process
// (--isolate).

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "core/figure/colour_scale.hpp"
#include "core/figure/view.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::work {

enum class PictureKind { layout_svg, layout_png, preview_png };

struct Picture {
  PictureKind kind = PictureKind::layout_svg;
  int size = figure::kDefaultImageSize;  ///< of PNGs, pixels
  // Of layouts.
  figure::Colouring colouring = figure::Colouring::stretch;
  bool legend = true;
  bool background = true;
  bool wireframe = false;
  bool numbers = false;        ///< of islands
  int page = 0;                ///< cropped to this page, from 1; 0: all pages, in one square
  bool has_page_size = false;  ///< in place of `size`: a pixel for each texel of the page
  // Of previews.
  std::optional<figure::Aspect> aspect = {};
  bool turns = false;  ///< a sheet of eight views
};

struct Rendering {
  std::size_t map = 0;                  ///< of the job, see lambda_selection.hpp
  std::optional<Picture> picture;       ///< none: the result
  std::optional<asset::Format> format;  ///< of the result; none: JSON
  /// What the mesh is, where a job may take so much memory; there is no map then.
  std::optional<std::size_t> analysis = {};
};

/// The stored files of a job. Of its record only the options and `synchronous` are used.
struct RenderingInput {
  const store::JobRecord& record;
  asset::Input asset;
  std::string_view uvs;     ///< of the map: what encode_uvs() wrote
  std::string_view report;  ///< of the map, JSON; of pictures only where they show pages
};

/// The bytes of the file. Throws what reading and writing the asset throw, storage_failed when the
/// map is none, invalid_option for a page that is not there or too large for a picture, cancelled
/// once the asset's token asks for a stop.
std::string render(const Rendering& rendering, const RenderingInput& input,
                   const api::Limits& limits);

}  // namespace unwrapd::server::work
