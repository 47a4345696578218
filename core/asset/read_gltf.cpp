#include "core/asset/read_gltf.hpp"

#include "core/asset/container.hpp"
#include "core/asset/gltf_steps.hpp"
#include "core/cancel.hpp"

namespace unwrapd::asset {

Gltf read_gltf(const Input& input, Format format, const ReadLimits& limits,
               const AssetOptions& options, std::vector<Surface>& surfaces) {
  Gltf gltf;
  gltf.texcoord = "TEXCOORD_" + std::to_string(options.texcoord);
  const GlbChunks chunks =
      format == Format::glb ? split_glb(input.document) : GlbChunks{input.document, {}, {}};
  gltf.stop = input.stop;
  gltf.json = parse_json(chunks.json, gltf.stop);
  gltf.other_chunks = chunks.others;
  if (chunks.unaligned > 0)
    gltf.repairs.push_back({FileRepairKind::chunks_padded, chunks.unaligned});
  check_asset_and_extensions(gltf);
  resolve_buffers(gltf, chunks.bin, input);
  read_views(gltf);
  decode_meshopt(gltf);
  read_accessors(gltf);
  if (const std::vector<DracoSource> sources = read_meshes(gltf); !sources.empty()) {
    decode_draco(gltf, sources, limits);
    gltf.came_as = Compression::draco;
    read_views(gltf);
    read_accessors(gltf);
    static_cast<void>(read_meshes(gltf));
  }
  check_nodes(gltf);
  select_primitives(gltf, options);
  check_geometry(gltf, limits);
  surfaces = build_surfaces(gltf, limits);
  return gltf;
}

}  // namespace unwrapd::asset
