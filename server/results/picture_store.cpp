#include "server/results/picture_store.hpp"

#include <bit>

#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::results {
namespace {

/// What a layout shows and does not: "area", or "wireframe.clear.bare.numbers.page1".
std::string look_name(const work::Picture& picture) {
  std::string name(picture.wireframe
                       ? "wireframe"
                       : figure::kColouringNames[static_cast<std::size_t>(picture.colouring)]);
  if (!picture.background) name += ".clear";
  if (!picture.legend) name += ".bare";
  if (picture.numbers) name += ".numbers";
  if (picture.page > 0) name += ".page" + std::to_string(picture.page);
  return name;
}

/// From where a preview is seen, "" or "30,-20.5.".
std::string view_name(const work::Picture& picture) {
  if (picture.turns) return "turntable.";
  if (!picture.aspect) return {};
  return api::Json(picture.aspect->azimuth).dump() + "," +
         api::Json(picture.aspect->elevation).dump() + ".";
}

/// "uv.bin.layout.area.1024.png": every parameter is in it.
std::string file_name(std::size_t map, const work::Picture& picture) {
  const std::string uv_file = work::map_file(blobs::kUvFile, map);
  const std::string size = picture.has_page_size ? "texels" : std::to_string(picture.size);
  switch (picture.kind) {
    case work::PictureKind::layout_svg:
      return uv_file + ".layout." + look_name(picture) + ".svg";
    case work::PictureKind::layout_png:
      return uv_file + ".layout." + look_name(picture) + "." + size + ".png";
    case work::PictureKind::preview_png:
      return uv_file + ".preview." + view_name(picture) + size + ".png";
  }
  return {};
}

constexpr int kLargeSize = 1024;  // pixels; larger ones take up to seconds

/// The most pixels along a side.
int longest_side(const work::Picture& picture) {
  return picture.has_page_size ? figure::kMaxImageSize : picture.size;
}

/// Memory for the pixels and for the file while it is written; a legend makes the picture an eighth
/// higher, and alpha takes a channel, in both and between them.
std::size_t bytes_of(const work::Picture& picture) {
  if (picture.kind == work::PictureKind::layout_svg) return 0;
  const auto side = static_cast<std::size_t>(longest_side(picture));
  return (picture.background ? 7 : 13) * side * side;
}

/// Coloured layouts as they are by default, and templates of a page, of some sizes; previews from
/// where most is seen. So that requests for every look do not fill the disk.
bool is_kept(const work::Picture& picture) {
  const bool is_template = picture.wireframe && !picture.background && picture.page > 0;
  const bool is_plain = picture.background && picture.legend && !picture.wireframe &&
                        !picture.numbers && picture.page == 0;
  if (picture.aspect || !(is_template || is_plain)) return false;
  return picture.kind == work::PictureKind::layout_svg || picture.has_page_size ||
         std::has_single_bit(static_cast<unsigned>(picture.size));
}

}  // namespace

StoredResult PictureStore::open(const store::JobRecord& job, std::size_t map,
                                const work::Picture& picture, const http::HasLeft& has_left) {
  const bool kept = is_kept(picture);
  const WantedFile wanted{.file = file_name(map, picture),
                          .map = map,
                          .bytes = bytes_of(picture),
                          .is_kept = kept,
                          .is_costly = !kept && longest_side(picture) > kLargeSize,
                          .has_left = has_left};
  return files_.open(job, wanted, [&] {
    return renderer_.render(job, {.map = map, .picture = picture, .format = {}}, has_left);
  });
}

}  // namespace unwrapd::server::results
