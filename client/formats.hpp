#pragma once
// Formats by the names of files.

#include <filesystem>
#include <string>

namespace unwrapd::client {

/// Whether unwrapd reads such files: by the extension alone.
bool is_mesh_name(const std::filesystem::path& path);

/// The format of a file name: "glb", "gltf", "obj", or "auto" for any other. Throws Failure{usage}
/// for the name of a format that is not written.
std::string format_of(const std::filesystem::path& path);

/// An archive's asset may have any format, so that the format of its result is to be named.
bool is_zip(const std::filesystem::path& path);

/// "-" for a stream (files.hpp). "folder/mesh.glb" becomes "folder/mesh.uv.glb". output ("obj")
/// changes the extension; "auto" or an empty text keeps it, unless the format is only read (STL,
/// PLY, OFF, a zip archive): then it is "glb". Of an address, the last part of its path counts;
/// throws Failure{usage} where that names no mesh.
std::filesystem::path default_out(const std::filesystem::path& file, const std::string& output);

}  // namespace unwrapd::client
