#pragma once
// The extensions that a document lists, and those that its objects have.

#include <string_view>

#include "core/asset/gltf/json.hpp"

namespace unwrapd::asset {

bool uses_extension(const Json& document, std::string_view name);
bool requires_extension(const Json& document, std::string_view name);

/// Removes `name` from extensionsUsed and extensionsRequired.
void forget_extension(Json& document, std::string_view name);

/// Removes `name` from the object's extensions, and the extensions if they are then empty.
void remove_extension(Json& object, std::string_view name);

}  // namespace unwrapd::asset
