#pragma once
// Recognises the format of a file by its content, since names and media types may be wrong.

#include <stop_token>
#include <string_view>

#include "core/asset/asset.hpp"

namespace unwrapd::asset {

/// GLB by its magic number, glTF by a brace, PLY, OFF and the text of an STL by their first word,
/// binary STL by the length that it announces, OBJ by a line of geometry. Comments and empty lines
/// before that line may be of any length, other statements 64 KiB. Throws Error{unknown_format},
/// with a specific message if the bytes are of another known format, and Error{cancelled}.
Format recognise(std::string_view file, const std::stop_token& stop);

}  // namespace unwrapd::asset
