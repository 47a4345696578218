#include "core/asset/reader/read_gltf.hpp"

#include <algorithm>

#include "core/asset/gltf/container.hpp"
#include "core/asset/gltf/extensions.hpp"
#include "core/asset/gltf/texture_slots.hpp"
#include "core/asset/reader/steps.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::reader {
namespace {

/// Whether readers without Draco find all of the geometry as well.
bool has_fallback(const Gltf& gltf, const std::vector<codec::DracoSource>& sources) {
  return !requires_extension(gltf.json, "KHR_draco_mesh_compression") &&
         std::all_of(sources.begin(), sources.end(), [&](const codec::DracoSource& source) {
           return gltf.accessors[gltf.primitives[source.primitive].position].view.has_value();
         });
}

}  // namespace

Gltf read_gltf(const Input& input, Format format, const ReadLimits& limits,
               const AssetOptions& options, std::vector<Surface>& surfaces) {
  Gltf gltf;
  const GlbChunks chunks =
      format == Format::glb ? split_glb(input.document) : GlbChunks{input.document, {}, {}};
  gltf.stop = input.stop;
  gltf.json =
      parse_json(chunks.json, gltf.stop, limits.max_bytes / 2);  // it is stored and later patched
  gltf.aside.take_unread(gltf.json);
  gltf.other_chunks = chunks.others;
  if (chunks.unaligned > 0)
    gltf.repairs.push_back({FileRepairKind::chunks_padded, chunks.unaligned});
  check_asset_and_extensions(gltf);
  gltf.came_as_text = format == Format::gltf;
  resolve_buffers(gltf, chunks.bin, input);
  take_images(gltf, input);
  read_views(gltf);
  if (codec::decode_meshopt(gltf)) read_views(gltf);
  read_accessors(gltf);
  if (const std::vector<codec::DracoSource> sources = read_meshes(gltf); !sources.empty()) {
    gltf.came_as = Compression::draco;
    gltf.came_with_fallback = has_fallback(gltf, sources);
    codec::decode_draco(gltf, sources, limits);
    read_views(gltf);
    read_accessors(gltf);
    static_cast<void>(read_meshes(gltf));
  }
  read_nodes(gltf);
  gltf.aside.take_unwritten(gltf.json);
  select_primitives(gltf, options);
  if (options.textures == TextureMode::transfer) gltf.transfer = {options.page, limits.max_bytes};
  choose_texcoord(gltf, options.texcoord);
  check_geometry(gltf, limits);
  surfaces = build_surfaces(gltf, limits);
  set_scales(gltf, surfaces);
  if (gltf.transfer) check_textures(gltf);
  return gltf;
}

}  // namespace unwrapd::asset::reader
