// The extensions that a document may require: those that do not affect geometry, and the
// compressions that asset undoes. Others are accepted if they are not required, and whatever they
// might refer to stays in its place.
#include <algorithm>
#include <array>

#include "core/asset/reader/steps.hpp"

namespace unwrapd::asset::reader {
namespace {

/// Neither touch geometry nor point at accessors, buffer views or buffers.
constexpr std::array<std::string_view, 41> kKnown = {
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_node_visibility",
    "KHR_physics_rigid_bodies",
    "KHR_implicit_shapes",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "ADOBE_materials_thin_transparency",
    "AGI_articulations",
    "FB_geometry_metadata",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
    "MPEG_texture_video",
};

/// Leave the vertices alone, but point at accessors of their own.
constexpr std::array<std::string_view, 5> kReferring = {
    "EXT_mesh_gpu_instancing", "CESIUM_primitive_outline", "EXT_mesh_features",
    "EXT_instance_features",   "EXT_structural_metadata",
};

template <class Names>
bool contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_version(const Node& root) {
  const Node version = root.at("asset").at("version");
  if (!version.text().starts_with("2."))
    fail(ErrorCode::malformed_gltf, version.place(),
         "only glTF 2 can be read; convert the asset to glTF 2.0");
}

void check_required(const Node& name) {
  if (contains(kKnown, name.text()) || contains(kReferring, name.text())) return;
  fail(ErrorCode::unsupported_extension, name.place(),
       "the asset requires the extension " + name.text() +
           ", which is not supported; export it without");
}

}  // namespace

void check_asset_and_extensions(Gltf& gltf) {
  const Node root(gltf.json);
  root.expect_object();
  check_version(root);
  if (const auto required = root.find("extensionsRequired"))
    for (std::size_t i = 0; i < required->array_size(); ++i) check_required(required->at(i));
  if (const auto used = root.find("extensionsUsed"))
    for (std::size_t i = 0; i < used->array_size(); ++i)
      gltf.has_foreign_references |= !contains(kKnown, used->at(i).text());
}

}  // namespace unwrapd::asset::reader
