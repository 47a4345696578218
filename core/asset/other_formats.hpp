#pragma once
// Formats of meshes that are recognised, but not read.

#include <string_view>

namespace unwrapd::asset {

/// Throws Error{unknown_format} if the file is in another format of meshes, with its name and how
/// to convert it.
void refuse_other_formats(std::string_view file);

}  // namespace unwrapd::asset
