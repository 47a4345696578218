#pragma once
// The bytes of a request, their formats, and how much of them is read.

#include <cstdint>
#include <limits>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>

namespace unwrapd::asset {

enum class Format { glb, gltf, obj, stl, ply, off };

/// "glb", "gltf", "obj", "stl", "ply" or "off".
std::string_view format_name(Format format);

/// The format of the answer to an input, unless another is asked for: its own if that is written,
/// else GLB. Only GLB, glTF and OBJ are written.
Format usual_output(Format input);

/// The bytes of a request. No other file or address is ever opened. buffers: a .gltf's external
/// buffers, or an OBJ's materials and their images, by the URI that the document uses for them.
struct Input {
  std::string_view document;
  std::map<std::string, std::string_view> buffers;
  std::stop_token stop = {};  ///< of the job; reading checks it, and later writing
};

inline constexpr std::size_t kNoByteLimit = std::numeric_limits<std::size_t>::max();

/// Checked against counts in the document before anything of their size is allocated.
struct ReadLimits {
  std::int64_t max_vertices = 10'000'000;
  std::int64_t max_faces = 20'000'000;
  std::size_t max_bytes = kNoByteLimit;                     ///< of memory for a job
  std::size_t max_unzipped_bytes = std::size_t{256} << 20;  ///< of the files in a zip archive
};

}  // namespace unwrapd::asset
