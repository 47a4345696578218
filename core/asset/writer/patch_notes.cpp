// What a patch changes beside the texture coordinates, said in sentences.
#include <algorithm>

#include "core/asset/gltf/images.hpp"
#include "core/asset/gltf/materials.hpp"
#include "core/asset/writer/patch.hpp"
#include "core/asset/writer/transfer_textures.hpp"

namespace unwrapd::asset::writer {
namespace {

constexpr std::size_t kMostUri = 80;  // characters of a URI that a note repeats

std::string counted(std::size_t count, const char* thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

/// The URI for a note; empty if it is long.
std::string named(const std::string& uri) {
  return uri.size() > kMostUri ? std::string() : ", as " + uri + ",";
}

bool is_morphed(const Gltf& gltf, const Primitive& primitive, const std::string& semantic) {
  const Json& json = json_of(gltf.json, primitive);
  const auto targets = json.find("targets");
  return targets != json.end() &&
         std::any_of(targets->begin(), targets->end(),
                     [&](const Json& target) { return target.contains(semantic); });
}

/// How many unwrapped primitives lose something, or get more than they had.
struct Changed {
  std::size_t tangents = 0, morphed_tangents = 0, morphed_texcoords = 0, lower_sets = 0;
};

Changed changed_primitives(const Gltf& gltf, const Materials& materials) {
  Changed changed;
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    if (materials.loses_tangents(primitive)) {
      ++changed.tangents;
      changed.morphed_tangents += is_morphed(gltf, primitive, "TANGENT") ? 1 : 0;
    }
    changed.morphed_texcoords += is_morphed(gltf, primitive, gltf.texcoord) ? 1 : 0;
    changed.lower_sets += missing_sets(gltf, primitive).empty() ? 0 : 1;
  }
  return changed;
}

/// add(holds, code, text) adds a note where it holds.
template <class Add>
void add_changes(const Changed& changed, const std::string& texcoord, const Add& add) {
  add(changed.tangents > 0, NoteCode::tangents_changed,
      "The tangents of " + counted(changed.tangents, "primitive") +
          " belonged to the replaced texture coordinates; they are computed again by MikkTSpace.");
  add(changed.morphed_tangents > 0, NoteCode::tangents_changed,
      "The morph targets of " + counted(changed.morphed_tangents, "primitive") +
          " had tangents for the replaced texture coordinates; the result leaves these out.");
  add(changed.morphed_texcoords > 0, NoteCode::morph_targets_lost,
      "The morph targets of " + counted(changed.morphed_texcoords, "primitive") +
          " moved the replaced texture coordinates; the result leaves this out.");
  add(changed.lower_sets > 0, NoteCode::sets_filled,
      counted(changed.lower_sets, "primitive") + " lacked texture coordinates below " + texcoord +
          "; glTF allows no gap, so these sets are the same.");
}

template <class Add>
void add_resets(const MaterialsToReset& to_reset, const std::string& texcoord, const Add& add) {
  const std::size_t copied = to_reset.copied.size(), reset = to_reset.in_place.size() + copied;
  add(reset > 0, NoteCode::transform_reset,
      "The KHR_texture_transform of " + counted(reset, "material") + " is reset for " + texcoord +
          "; its new coordinates need no transform.");
  add(copied > 0, NoteCode::materials_copied,
      counted(copied, "material") +
          " of these are also on primitives that are not unwrapped; the unwrapped ones have "
          "copies.");
}

}  // namespace

std::vector<std::string> missing_sets(const Gltf& gltf, const Primitive& primitive) {
  std::vector<std::string> missing;
  for (int n = 0; n <= kMaxTexcoord; ++n) {
    const std::string set = "TEXCOORD_" + std::to_string(n);
    if (set == gltf.texcoord) break;
    const auto is_set = [&](const auto& item) { return item.first == set; };
    if (std::none_of(primitive.attributes.begin(), primitive.attributes.end(), is_set))
      missing.push_back(set);
  }
  return missing;
}

std::vector<Note> side_effects_of_patch(const Gltf& gltf,
                                        std::span<const UnwrappedSurface> unwrapped,
                                        Format output) {
  const Materials materials(gltf);
  std::vector<Note> notes;
  if (gltf.transfer) notes = notes_on_transfer(gltf, unwrapped);
  const auto add = [&](bool holds, NoteCode code, std::string text) {
    if (holds) notes.push_back({code, std::move(text)});
  };
  add(gltf.has_no_free_texcoord, NoteCode::set_chosen,
      "The asset has all eight sets of texture coordinates. The new ones replace " + gltf.texcoord +
          ", the first that no texture samples; its values are lost. Name another set to keep "
          "them, for example texcoord=7.");
  add(gltf.is_texcoord_chosen && !gltf.has_no_free_texcoord && gltf.texcoord != gltf.uvs_from,
      NoteCode::set_chosen,
      "The new texture coordinates are " + gltf.texcoord +
          ", and the existing sets stay, so that textures of the asset keep fitting. Send "
          "textures=transfer to have them painted for the new ones, or texcoord=0 to overwrite the "
          "first set.");
  add(!gltf.transfer &&
          sampled_sets(gltf).test(static_cast<std::size_t>(gltf.texcoord.back() - '0')),
      NoteCode::textures_lost,
      "Textures of the asset sample " + gltf.texcoord +
          ", which is replaced: their images no longer fit. Leave texcoord out to write another "
          "set, or send textures=transfer to have them painted anew.");
  add_changes(changed_primitives(gltf, materials), gltf.texcoord, add);
  if (!gltf.transfer) add_resets(materials.to_reset(), gltf.texcoord, add);
  const FilesBeside files = images_beside(gltf);
  add(gltf.came_as_text && output == Format::glb && files.count > 0, NoteCode::images_separate,
      counted(files.count, "image") + " of the asset" + named(files.first) +
          " remain in separate files; keep them beside the GLB, or send them with the request, as "
          "unwrap does where they lie beside the .gltf.");
  return notes;
}

}  // namespace unwrapd::asset::writer
