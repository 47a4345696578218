#pragma once
// Reading a glTF, step by step, in the order in which the steps run. Each refuses what it finds
// wrong with an Error that names the place; each may rely on what the steps before it have checked.
// The last two compressions are undone in place: from there on the document is a plain glTF.

#include <vector>

#include "core/asset/asset.hpp"
#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// A primitive whose geometry is a Draco bitstream.
struct DracoSource {
  std::size_t primitive = 0;                                    ///< in Gltf::primitives
  std::size_t view = 0;                                         ///< where the bitstream lies
  std::vector<std::pair<std::string, std::size_t>> attributes;  ///< semantic, id in the bitstream
};

/// Version 2.x, and no required extension that we do not know.
void check_asset_and_extensions(Gltf& gltf);

/// Fills buffers: the GLB's chunk, data URIs, and the request's own parts; nothing else is opened.
void resolve_buffers(Gltf& gltf, std::string_view bin, const Input& input);

/// Fills sent_images: those that the document names by a URI and the request has as parts.
void take_images(Gltf& gltf, const Input& input);

void read_views(Gltf& gltf);

/// Decodes the views with EXT_meshopt_compression or KHR_meshopt_compression.
void decode_meshopt(Gltf& gltf);

void read_accessors(Gltf& gltf);

/// Meshes, and the graph of nodes as far as it must be sound: references, no cycle.
std::vector<DracoSource> read_meshes(Gltf& gltf);
void check_nodes(Gltf& gltf);

/// Decodes the primitives with KHR_draco_mesh_compression into accessors of the document, whose
/// views, accessors and meshes must then be read again.
void decode_draco(Gltf& gltf, const std::vector<DracoSource>& sources, const ReadLimits& limits);

/// Types and counts of what makes up the triangles; nothing larger than limits gets past.
void check_geometry(Gltf& gltf, const ReadLimits& limits);

/// Leaves has_triangles to the primitives that the options select. Throws Error{invalid_option}
/// for a name that nothing has.
void select_primitives(Gltf& gltf, const AssetOptions& options);

/// One surface for each mesh that has triangles of its own; fills pieces, vertices and pools.
std::vector<Surface> build_surfaces(Gltf& gltf, const ReadLimits& limits);

/// Fills corner_uv from the attribute gltf.texcoord; surfaces without it stay without.
void read_gltf_uvs(const Gltf& gltf, std::vector<Surface>& surfaces);

bool uses_extension(const Json& document, std::string_view name);
bool requires_extension(const Json& document, std::string_view name);

/// Appends a buffer, in the model and in the document.
void add_buffer(Gltf& gltf, std::string bytes);

/// Takes `name` out of extensionsUsed and extensionsRequired.
void forget_extension(Json& document, std::string_view name);

/// Takes `name` out of the object's extensions, and the extensions when nothing is left.
void remove_extension(Json& object, std::string_view name);

}  // namespace unwrapd::asset
