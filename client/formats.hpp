#pragma once
// Formats by the names of files.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// The extension in small letters, without its dot.
std::string extension_of(const std::filesystem::path& path);

/// Whether unwrapd reads such files: by the extension alone.
bool is_mesh_name(const std::filesystem::path& path);

/// The format of a file name: "glb", "gltf", "obj", or "auto" for any other. Throws Failure{usage}
/// for the name of a format that is not written.
std::string format_of(const std::filesystem::path& path);

/// The format to ask for where nothing names one, so that the result's name tells what is in it:
/// "glb" for an archive, and for a name that does not tell the format of its mesh; else "auto", the
/// format of the input, or GLB where that is only read (STL, PLY, OFF).
std::string usual_output(const std::filesystem::path& file);

/// Throws Failure{usage} for an ending of a picture's name that is not one of these ("png"), in
/// capital or small letters. A name may have none.
void check_ending(const std::string& flag, const std::filesystem::path& path,
                  std::span<const std::string_view> known);

/// Whether the name ends in .png, in capital or small letters.
bool is_png(const std::filesystem::path& path);

/// "-" for a stream (files.hpp). "folder/mesh.glb" becomes "folder/mesh.uv.glb". output ("obj")
/// changes the extension; "auto" or an empty text keeps it where such files are written, else it is
/// "glb". Of an address, the last part of its path counts; throws Failure{usage} where that names
/// no mesh.
std::filesystem::path default_out(const std::filesystem::path& file, const std::string& output);

}  // namespace unwrapd::client
