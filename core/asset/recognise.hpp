#pragma once
// What a file is, by its content: names and media types lie.

#include <stop_token>
#include <string_view>

#include "core/asset/asset.hpp"

namespace unwrapd::asset {

/// GLB by its magic number, glTF by a brace. OBJ by a line of geometry: comments and empty lines
/// before it may be of any length, other statements 64 KiB. Throws Error{unknown_format}, with a
/// message of its own where the bytes are those of a known other format, and Error{cancelled}.
Format recognise(std::string_view file, const std::stop_token& stop);

}  // namespace unwrapd::asset
