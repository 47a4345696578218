#pragma once
// Where a document refers to accessors and to buffer views, in the core of glTF 2.0. By the time
// this is used the compressions that hold references of their own have been undone.

#include <functional>
#include <vector>

#include "core/asset/json.hpp"

namespace unwrapd::asset {

/// How often each of `count` accessors is referred to: attributes, morph targets, indices,
/// animations, skins. References out of range are passed over.
std::vector<std::size_t> count_accessor_references(const Json& document, std::size_t count);

/// Calls visit with every number that names an accessor.
void for_each_accessor_reference(Json& document, const std::function<void(Json&)>& visit);

/// Calls visit with every number that names a buffer view: of accessors, sparse parts, images,
/// Draco's bitstreams.
void for_each_view_reference(Json& document, const std::function<void(Json&)>& visit);
void for_each_view_reference(const Json& document, const std::function<void(const Json&)>& visit);

/// Those of images and Draco's bitstreams alone.
void for_each_other_view_reference(const Json& document,
                                   const std::function<void(const Json&)>& visit);

}  // namespace unwrapd::asset
