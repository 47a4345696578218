#include "server/results/picture_store.hpp"

#include <bit>

#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::results {
namespace {

/// "uv.bin.layout.area.1024.png".
std::string file_name(std::size_t map, const work::Picture& picture) {
  const std::string uv_file = work::map_file(store::kUvFile, map);
  const std::string colour(figure::kColouringNames[static_cast<std::size_t>(picture.colouring)]);
  const std::string size = std::to_string(picture.size);
  switch (picture.kind) {
    case work::PictureKind::layout_svg:
      return uv_file + ".layout." + colour + ".svg";
    case work::PictureKind::layout_png:
      return uv_file + ".layout." + colour + "." + size + ".png";
    case work::PictureKind::preview_png:
      return uv_file + ".preview." + size + ".png";
  }
  return {};
}

constexpr int kLargeSize = 1024;  // pixels; larger ones take up to seconds

/// Memory for the pixels and for the file while it is written; a legend makes the picture an eighth
/// higher.
std::size_t bytes_of(const work::Picture& picture) {
  if (picture.kind == work::PictureKind::layout_svg) return 0;
  const auto side = static_cast<std::size_t>(picture.size);
  return 7 * side * side;
}

bool is_kept(const work::Picture& picture) {
  return picture.kind == work::PictureKind::layout_svg ||
         std::has_single_bit(static_cast<unsigned>(picture.size));
}

}  // namespace

StoredResult PictureStore::open(const store::JobRecord& job, std::size_t map,
                                const work::Picture& picture, const http::HasLeft& has_left) {
  const std::string name = file_name(map, picture);
  std::optional<StoredResult> kept;
  if (is_kept(picture)) kept = find_whole(blobs_, job.id, name);
  std::shared_ptr<void> place;
  if (!kept) {
    place = renderer_.enter(job, {.file = name,
                                  .map = map,
                                  .bytes = bytes_of(picture),
                                  .is_costly = !is_kept(picture) && picture.size > kLargeSize,
                                  .has_left = has_left});
    kept = find_whole(blobs_, job.id, name);  // drawn meanwhile
  }
  if (kept) {
    ++counts_.hits;
    return std::move(*kept);
  }
  const std::string bytes =
      renderer_.render(job, {.map = map, .picture = picture, .format = {}}, has_left);
  counts_.made(bytes);
  return is_kept(picture) ? keep(blobs_, job, name, bytes) : lend(blobs_, bytes);
}

}  // namespace unwrapd::server::results
