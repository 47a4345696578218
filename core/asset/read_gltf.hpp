#pragma once
// From the bytes of a GLB or .gltf to a checked document and its surfaces.

#include <vector>

#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// Reads a GLB or .gltf and the geometry that the options select. The document comes out
/// uncompressed.
Gltf read_gltf(const Input& input, Format format, const ReadLimits& limits,
               const AssetOptions& options, std::vector<Surface>& surfaces);

}  // namespace unwrapd::asset
