#pragma once
// Undoes the compressions of a document in place.

#include <string>
#include <utility>
#include <vector>

#include "core/asset/base/input.hpp"
#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset::codec {

/// A primitive whose geometry is a Draco bitstream.
struct DracoSource {
  std::size_t primitive = 0;                                    ///< index in Gltf::primitives
  std::size_t view = 0;                                         ///< view of the bitstream
  std::vector<std::pair<std::string, std::size_t>> attributes;  ///< semantic, id in the bitstream
};

/// Decodes the views with EXT_meshopt_compression or KHR_meshopt_compression. Whether there were
/// any: views must then be read again.
bool decode_meshopt(Gltf& gltf);

/// Decodes the primitives with KHR_draco_mesh_compression into accessors of the document, whose
/// views, accessors and meshes must then be read again.
void decode_draco(Gltf& gltf, const std::vector<DracoSource>& sources, const ReadLimits& limits);

}  // namespace unwrapd::asset::codec
