#pragma once
// Finds the references to accessors and buffer views in a document of core glTF 2.0. The
// compressions, which have references of their own, have been undone before.

#include <functional>
#include <vector>

#include "core/asset/gltf/json.hpp"

namespace unwrapd::asset {

/// The number of references to each of `count` accessors: attributes, morph targets, indices,
/// animations, skins. References out of range are ignored.
std::vector<std::size_t> count_accessor_references(const Json& document, std::size_t count);

/// Calls visit with every number that names an accessor.
void for_each_accessor_reference(Json& document, const std::function<void(Json&)>& visit);

/// Calls visit with every number that names a buffer view: of accessors, sparse parts, images,
/// Draco's bitstreams.
void for_each_view_reference(Json& document, const std::function<void(Json&)>& visit);
void for_each_view_reference(const Json& document, const std::function<void(const Json&)>& visit);

/// Only the references of images and Draco's bitstreams.
void for_each_other_view_reference(const Json& document,
                                   const std::function<void(const Json&)>& visit);

}  // namespace unwrapd::asset
