#include "server/picture_store.hpp"

#include <bit>
#include <filesystem>

#include "server/identity.hpp"
#include "server/map_choice.hpp"

namespace unwrapd::server {
namespace {

namespace fs = std::filesystem;

/// "layout.svg" for what the worker has drawn already, else "uv.bin.layout.area.1024.png".
std::string file_name(std::size_t map, const Picture& picture) {
  const std::string uv_file = map_file(kUvFile, map);
  const std::string colour(kColouringNames[static_cast<std::size_t>(picture.colouring)]);
  const std::string size = std::to_string(picture.size);
  switch (picture.kind) {
    case PictureKind::layout_svg:
      if (map == 0 && picture.colouring == Colouring::stretch) return std::string(kLayoutFile);
      return uv_file + ".layout." + colour + ".svg";
    case PictureKind::layout_png:
      return uv_file + ".layout." + colour + "." + size + ".png";
    case PictureKind::preview_png:
      return uv_file + ".preview." + size + ".png";
  }
  return {};
}

bool is_kept(const Picture& picture) {
  return picture.kind == PictureKind::layout_svg ||
         std::has_single_bit(static_cast<unsigned>(picture.size));
}

}  // namespace

StoredResult PictureStore::open(const JobRecord& job, std::size_t map, const Picture& picture) {
  const std::string name = file_name(map, picture), digest = name + ".sha256";
  const fs::path path = blobs_.path(job.id, name);
  const std::lock_guard lock(drawing_);
  if (fs::exists(path))
    ++counts_.hits;
  else
    draw_into_store(job, {.map = map, .picture = picture, .format = {}}, name);
  if (!fs::exists(blobs_.path(job.id, digest)))
    blobs_.write(job.id, digest, sha256(read_file(path)));
  StoredResult stored{.file = std::make_shared<const File>(File::open(path)),
                      .sha256 = read_file(blobs_.path(job.id, digest))};
  if (is_kept(picture)) return stored;
  blobs_.discard(job.id, name);
  blobs_.discard(job.id, digest);
  return stored;
}

void PictureStore::draw_into_store(const JobRecord& job, const Rendering& rendering,
                                   const std::string& name) {
  const std::string bytes = renderer_.render(job, rendering);
  counts_.made(bytes);
  blobs_.write(job.id, name, bytes);
}

}  // namespace unwrapd::server
