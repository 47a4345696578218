#pragma once
// The GLB container (glTF 2.0, section 4): a header and chunks.

#include <string>
#include <string_view>

namespace unwrapd::asset {

/// Views into the file.
struct GlbChunks {
  std::string_view json;
  std::string_view bin = {};  ///< empty when there is no such chunk
  std::string others = {};    ///< all later chunks, as a file has them
  int unaligned = 0;          ///< chunks whose length was no multiple of 4
};

/// Throws Error{malformed_glb} unless version, lengths and chunk order are right. A chunk's length
/// should be a multiple of 4: where it is not, the next chunk follows at once or after padding, and
/// is looked for in this order. Bytes after the length that the file states are ignored.
GlbChunks split_glb(std::string_view bytes);

/// Throws Error{body_too_large} when the file would pass the container's 4 GiB.
std::string join_glb(std::string_view json, std::string_view bin, std::string_view others);

}  // namespace unwrapd::asset
