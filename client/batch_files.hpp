#pragma once
// The meshes of a command that names several files or folders.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace unwrapd::client {

struct BatchFile {
  std::filesystem::path file;
  std::filesystem::path out;
};

/// What the inputs name: files, patterns ("meshes/*.glb"), and folders with all meshes below them
/// but results ("chair.uv.glb", or what lies in `folder`), by name. Results lie beside their meshes
/// (formats.hpp, default_out()); in `folder`, if it is not empty, under the names that the meshes
/// have below the input. output: the format, or "auto". Throws Failure: usage where two results
/// would be one file, file for a folder that cannot be read.
std::vector<BatchFile> batch_files(std::span<const std::filesystem::path> inputs,
                                   const std::filesystem::path& folder, const std::string& output);

/// Whether the result is there and newer than its mesh.
bool is_done(const BatchFile& item);

}  // namespace unwrapd::client
