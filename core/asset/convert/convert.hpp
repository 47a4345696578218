#pragma once
// Converts between the formats: geometry, normals and UVs, since OBJ and the bare formats of
// geometry have little else.

#include <span>
#include <string>
#include <vector>

#include "core/asset/gltf/gltf.hpp"
#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::convert {

/// A minimal glTF: one node, one mesh, one primitive for each material that has faces, with its
/// name and looks. keeps_texcoords: see there. Positions are in the float_frame() of the mesh.
/// Throws Error{zero_area, cancelled}.
std::string obj_as_gltf(const obj::Obj& obj, const Surface& surface,
                        const UnwrappedSurface& unwrapped, bool keeps_texcoords, Format output);

/// The vertex of the OBJ that each vertex of that glTF copies.
std::vector<Index> sources_in_gltf(const obj::Obj& obj, const Surface& surface,
                                   const UnwrappedSurface& unwrapped, bool keeps_texcoords);

/// obj_as_gltf() for STL, PLY and OFF.
std::string mesh_file_as_gltf(const mesh_files::MeshFile& file, const Surface& surface,
                              const UnwrappedSurface& unwrapped, Format output);
std::vector<Index> sources_in_gltf(const mesh_files::MeshFile& file, const Surface& surface,
                                   const UnwrappedSurface& unwrapped);

/// Triangles with their normals, if the file has any.
std::string mesh_file_as_obj(const mesh_files::MeshFile& file, const Surface& surface,
                             const UnwrappedSurface& unwrapped);

/// One object ("o") for each mesh, where the first node of the scene shows it.
std::string gltf_as_obj(const Gltf& gltf, std::span<const Surface> surfaces,
                        std::span<const UnwrappedSurface> unwrapped);

/// What that OBJ lacks of the glTF.
std::vector<Note> notes_on_obj_of_gltf(const Gltf& gltf);

}  // namespace unwrapd::asset::convert
