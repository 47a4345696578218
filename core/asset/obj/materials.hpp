#pragma once
// The materials of an OBJ in a glTF: what the MTL files say of them, and their images.

#include <span>
#include <string>
#include <vector>

#include "core/asset/gltf/new_accessors.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::obj {

/// Reads the MTL files that the OBJ names and that were sent, and takes their images.
void read_materials(const Input& input, Obj& obj);

/// Whether images of its materials shall keep fitting: the glTF then has the OBJ's own texture
/// coordinates as TEXCOORD_0 and the new ones as TEXCOORD_1.
bool keeps_texcoords(const Obj& obj, const AssetOptions& options);

/// Whether the material of a part has an image as its colour.
bool has_image(const Obj& obj, Index part);

/// Sets materials, textures and images of the document, and the materials of its primitives.
/// parts: of each primitive of the one mesh.
void add_materials(const Obj& obj, std::span<const Index> parts, NewViews& views, Json& json);

/// Notes on what a glTF of the OBJ lacks, and on what became of materials and their images.
std::vector<Note> note_on_materials(const Obj& obj);

}  // namespace unwrapd::asset::obj
