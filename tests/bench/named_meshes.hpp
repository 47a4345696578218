#pragma once
// The meshes that a benchmark is told to measure: files, folders, and shapes made on the spot.

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// Whether the name is "noisy:FACES" (a body like a scan) or "made:FAMILY:FACES:SEED"
/// (made_shape()), not a file's.
bool is_generated(const std::string& name);

/// The surfaces of a .obj, .glb or .gltf file, the latter with the files beside it, or of a
/// generated mesh. Throws Error where a file cannot be read.
std::vector<Surface> read_surfaces(const std::filesystem::path& path);

/// The path itself, or if it is a folder all meshes in it, in the order of their names.
std::vector<std::filesystem::path> meshes_in(const std::filesystem::path& path);

}  // namespace unwrapd::bench
