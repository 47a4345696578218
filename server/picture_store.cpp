#include "server/picture_store.hpp"

#include <bit>
#include <filesystem>
#include <vector>

#include "api/options.hpp"
#include "core/figure/layout_image.hpp"
#include "core/figure/layout_svg.hpp"
#include "core/figure/preview.hpp"
#include "server/identity.hpp"
#include "server/job_input.hpp"
#include "server/png_file.hpp"
#include "server/run_job.hpp"
#include "server/uv_file.hpp"

namespace unwrapd::server {
namespace {

namespace fs = std::filesystem;

/// "layout.svg" for what the worker has drawn already, else "uv.bin.layout.area.1024.png".
std::string file_name(const Picture& picture) {
  const std::string colour(kColouringNames[static_cast<std::size_t>(picture.colouring)]);
  const std::string size = std::to_string(picture.size);
  switch (picture.kind) {
    case PictureKind::layout_svg:
      if (picture.uv_file == kUvFile && picture.colouring == Colouring::stretch)
        return std::string(kLayoutFile);
      return picture.uv_file + ".layout." + colour + ".svg";
    case PictureKind::layout_png:
      return picture.uv_file + ".layout." + colour + "." + size + ".png";
    case PictureKind::preview_png:
      return picture.uv_file + ".preview." + size + ".png";
  }
  return {};
}

bool is_kept(const Picture& picture) {
  return picture.kind == PictureKind::layout_svg ||
         std::has_single_bit(static_cast<unsigned>(picture.size));
}

}  // namespace

StoredResult PictureStore::open(const JobRecord& job, const Picture& picture) {
  const std::string name = file_name(picture), digest = name + ".sha256";
  const fs::path path = blobs_.path(job.id, name);
  const std::lock_guard lock(drawing_);
  if (fs::exists(path))
    ++counts_.hits;
  else
    draw_into_store(job, picture, name);
  if (!fs::exists(blobs_.path(job.id, digest)))
    blobs_.write(job.id, digest, sha256(read_file(path)));
  StoredResult stored{.file = std::make_shared<const File>(File::open(path)),
                      .sha256 = read_file(blobs_.path(job.id, digest))};
  if (is_kept(picture)) return stored;
  blobs_.discard(job.id, name);
  blobs_.discard(job.id, digest);
  return stored;
}

void PictureStore::draw_into_store(const JobRecord& job, const Picture& picture,
                                   const std::string& name) {
  const std::string bytes = draw(job, picture);
  counts_.made(bytes);
  blobs_.write(job.id, name, bytes);
}

std::string PictureStore::draw(const JobRecord& job, const Picture& picture) const {
  const LoadedInput loaded(blobs_, job);
  const asset::Asset asset = asset::read(loaded.input(), read_limits(job, limits_),
                                         api::parse_options(job.options, limits_).asset);
  const std::vector<UnwrappedSurface> unwrapped = decode_uvs(blobs_.read(job.id, picture.uv_file));
  switch (picture.kind) {
    case PictureKind::layout_svg:
      return layout_svg(asset.surfaces(), unwrapped, picture.colouring);
    case PictureKind::layout_png:
      return encode_png(layout_image(asset.surfaces(), unwrapped, picture.colouring, picture.size));
    case PictureKind::preview_png:
      return encode_png(preview(asset.surfaces(), unwrapped, picture.size));
  }
  return {};
}

}  // namespace unwrapd::server
