#pragma once
// The steps of reading a glTF, in their order. Each step refuses faults with an Error that names
// the place, and relies on the checks of the steps before it. Between them core/asset/codec undoes
// the two compressions in place: after that the document is a plain glTF.

#include <vector>

#include "core/asset/base/input.hpp"
#include "core/asset/codec/decompress.hpp"
#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset::reader {

/// How many entries a list of the root has; 0 without it. Throws when it is no array.
std::size_t list_size(const Gltf& gltf, std::string_view name);

/// Requires version 2.x, and that every required extension is known.
void check_asset_and_extensions(Gltf& gltf);

/// Fills buffers from the GLB's chunk, data URIs, and the request's parts; nothing else is opened.
void resolve_buffers(Gltf& gltf, std::string_view bin, const Input& input);

/// Fills sent_images with the images that the document names by a URI and the request has as parts.
void take_images(Gltf& gltf, const Input& input);

void read_views(Gltf& gltf);

void read_accessors(Gltf& gltf);

std::vector<codec::DracoSource> read_meshes(Gltf& gltf);

/// Checks the graph of nodes: references, no cycle. Fills mesh_nodes with those of the default
/// scene, or with all where it shows no mesh.
void read_nodes(Gltf& gltf);

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

/// Fills Surface::scale from the nodes.
void set_scales(const Gltf& gltf, std::vector<Surface>& surfaces);

/// Fills corner_uv from the attribute gltf.uvs_from, on the surfaces that have it.
void read_gltf_uvs(const Gltf& gltf, std::vector<Surface>& surfaces);

}  // namespace unwrapd::asset::reader
