#pragma once
// What a file is, by its content: names and media types lie.

#include <string_view>

#include "core/asset/asset.hpp"

namespace unwrapd::asset {

/// Throws Error{unknown_format}; says so where the bytes are those of a known other format.
Format recognise(std::string_view file);

}  // namespace unwrapd::asset
