#pragma once
// A zip archive with one asset in it: a glTF and the files that it names, or another format's file.

#include <cstddef>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>

namespace unwrapd::asset {

struct Unzipped {
  std::string document;
  std::map<std::string, std::string> files;  ///< by their paths from the folder of the asset
};

/// Whether the file is a zip archive.
bool is_zip(std::string_view file);

/// Unpacks the one asset, and for a .gltf the files below its folder; for an OBJ the MTL, PNG and
/// JPEG files there, as far as there is room. All together have max_bytes at most.
/// Paths are names only: nothing is written, and no link is followed. Throws Error{unknown_format}
/// if there is none or more than one, malformed_mesh if the archive is broken, body_too_large, and
/// cancelled.
Unzipped unzip(std::string_view archive, std::size_t max_bytes, const std::stop_token& stop);

}  // namespace unwrapd::asset
