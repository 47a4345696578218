#pragma once
// The GLB container (glTF 2.0, section 4): a header and chunks.

#include <string>
#include <string_view>

namespace unwrapd::asset {

/// Views into the file.
struct GlbChunks {
  std::string_view json;
  std::string_view bin = {};  ///< empty if there is no such chunk
  std::string others = {};    ///< all later chunks, in the format of a file
  int unaligned = 0;          ///< chunks whose length is not a multiple of 4
};

/// Throws Error{malformed_glb} unless version, lengths and chunk order are right. A chunk's length
/// should be a multiple of 4. If it is not, the next chunk is searched at once and after padding,
/// in this order. Bytes after the stated length are ignored.
GlbChunks split_glb(std::string_view bytes);

/// Throws Error{body_too_large} if the file exceeds the container's 4 GiB.
std::string join_glb(std::string_view json, std::string_view bin, std::string_view others);

}  // namespace unwrapd::asset
