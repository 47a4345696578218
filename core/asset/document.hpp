#pragma once
// The contents of an Asset: its surfaces, and the document that write() patches.

#include <variant>
#include <vector>

#include "core/asset/asset.hpp"
#include "core/asset/gltf/gltf.hpp"
#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/obj/obj.hpp"

namespace unwrapd::asset {

struct Document {
  Format format = Format::glb;
  AssetOptions options;
  std::vector<Surface> surfaces;
  std::variant<Gltf, obj::Obj, mesh_files::MeshFile> source;
};

}  // namespace unwrapd::asset
