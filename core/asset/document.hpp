#pragma once
// The contents of an Asset: its surfaces, and the document that write() patches.

#include <variant>
#include <vector>

#include "core/asset/asset.hpp"
#include "core/asset/gltf.hpp"
#include "core/asset/mesh_file.hpp"
#include "core/asset/obj.hpp"

namespace unwrapd::asset {

struct Document {
  Format format = Format::glb;
  AssetOptions options;
  std::vector<Surface> surfaces;
  std::variant<Gltf, Obj, MeshFile> source;
};

}  // namespace unwrapd::asset
