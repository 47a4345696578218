#pragma once
// The steps of reading a glTF, in their order. Each step refuses faults with an Error that names
// the place, and relies on the checks of the steps before it. The two compressions are undone in
// place: after that the document is a plain glTF.

#include <vector>

#include "core/asset/asset.hpp"
#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// A primitive whose geometry is a Draco bitstream.
struct DracoSource {
  std::size_t primitive = 0;                                    ///< index in Gltf::primitives
  std::size_t view = 0;                                         ///< view of the bitstream
  std::vector<std::pair<std::string, std::size_t>> attributes;  ///< semantic, id in the bitstream
};

/// Requires version 2.x, and that every required extension is known.
void check_asset_and_extensions(Gltf& gltf);

/// Fills buffers from the GLB's chunk, data URIs, and the request's parts; nothing else is opened.
void resolve_buffers(Gltf& gltf, std::string_view bin, const Input& input);

/// The bytes of a data URI. Throws Error{malformed_gltf}, Error{cancelled}.
std::string data_uri_bytes(const Node& uri, const std::stop_token& stop);

/// Whether a path leads below its folder: it has no scheme, no parent and no odd characters.
bool is_plain_relative(std::string_view path);

/// Fills sent_images with the images that the document names by a URI and the request has as parts.
void take_images(Gltf& gltf, const Input& input);

void read_views(Gltf& gltf);

/// Decodes the views with EXT_meshopt_compression or KHR_meshopt_compression.
void decode_meshopt(Gltf& gltf);

void read_accessors(Gltf& gltf);

/// Reads meshes, and checks the graph of nodes: references, no cycle.
std::vector<DracoSource> read_meshes(Gltf& gltf);
void check_nodes(Gltf& gltf);

/// Decodes the primitives with KHR_draco_mesh_compression into accessors of the document, whose
/// views, accessors and meshes must then be read again.
void decode_draco(Gltf& gltf, const std::vector<DracoSource>& sources, const ReadLimits& limits);

/// Checks types and counts of the data of triangles, and the limits.
void check_geometry(Gltf& gltf, const ReadLimits& limits);

/// Clears has_triangles of the primitives that the options do not select. Throws
/// Error{invalid_option} for a name that nothing has.
void select_primitives(Gltf& gltf, const AssetOptions& options);

/// Sets gltf.texcoord and gltf.uvs_from; where textures are transferred, it chooses what they
/// sample. Throws Error{invalid_option} if no set is left to choose.
void choose_texcoord(Gltf& gltf, const std::variant<int, TexcoordChoice>& asked);

/// One surface for each mesh that has triangles of its own; fills pieces, vertices and pools.
std::vector<Surface> build_surfaces(Gltf& gltf, const ReadLimits& limits);

/// Fills corner_uv from the attribute gltf.uvs_from, on the surfaces that have it.
void read_gltf_uvs(const Gltf& gltf, std::vector<Surface>& surfaces);

bool uses_extension(const Json& document, std::string_view name);
bool requires_extension(const Json& document, std::string_view name);

/// Appends a buffer, in the model and in the document.
void add_buffer(Gltf& gltf, std::string bytes);

/// Removes `name` from extensionsUsed and extensionsRequired.
void forget_extension(Json& document, std::string_view name);

/// Removes `name` from the object's extensions, and the extensions if they are then empty.
void remove_extension(Json& object, std::string_view name);

}  // namespace unwrapd::asset
