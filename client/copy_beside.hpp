#pragma once
// A .gltf and an OBJ refer to files beside them. A result in another folder needs these, too.

#include <string>
#include <vector>

#include "client/arguments.hpp"

namespace unwrapd::client {

/// Copies what the written result refers to from beside the input, under the same names: images of
/// a glTF, the materials of an OBJ with their images. Nothing is written outside the result's
/// folder, and a file that is there stays. Returns a sentence on what could not be copied, and one
/// on files there that differ from those beside the input.
std::vector<std::string> copy_beside(const Arguments& arguments);

}  // namespace unwrapd::client
