#pragma once
// Reads the bytes of a GLB or .gltf into a checked document and its surfaces.

#include <vector>

#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset::reader {

/// Reads a GLB or .gltf and the geometry that the options select. The document is uncompressed
/// afterwards.
Gltf read_gltf(const Input& input, Format format, const ReadLimits& limits,
               const AssetOptions& options, std::vector<Surface>& surfaces);

}  // namespace unwrapd::asset::reader
