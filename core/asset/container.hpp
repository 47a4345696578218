#pragma once
// The GLB container (glTF 2.0, section 4): a header and chunks.

#include <string>
#include <string_view>

namespace unwrapd::asset {

/// Views into the file. bin is empty when there is no such chunk; others holds all later chunks.
struct GlbChunks {
  std::string_view json;
  std::string_view bin;
  std::string_view others;
};

/// Throws Error{malformed_glb} unless version, lengths and chunk order are right. Bytes after the
/// length that the file states are ignored.
GlbChunks split_glb(std::string_view bytes);

/// Throws Error{body_too_large} when the file would pass the container's 4 GiB.
std::string join_glb(const GlbChunks& chunks);

}  // namespace unwrapd::asset
