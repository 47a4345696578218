// Chooses the set of texture coordinates to write, so that textures of the asset keep fitting where
// the caller names no set.
#include <string>
#include <variant>

#include "core/asset/gltf/materials.hpp"
#include "core/asset/reader/steps.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::reader {
namespace {

/// The first set that is not taken, if there is one.
std::optional<int> first_outside(const TexcoordSets& taken) {
  for (std::size_t set = 0; set < taken.size(); ++set)
    if (!taken.test(set)) return static_cast<int>(set);
  return std::nullopt;
}

int chosen_set(Gltf& gltf, TexcoordChoice choice) {
  const TexcoordSets sampled = sampled_sets(gltf);
  if (choice == TexcoordChoice::automatic && gltf.transfer)
    return first_outside(~sampled).value_or(0);
  if (choice == TexcoordChoice::automatic && !sampled.test(0)) return 0;
  if (const auto free = first_outside(sampled | present_sets(gltf))) return *free;
  gltf.has_no_free_texcoord = true;
  if (const auto unsampled = first_outside(sampled)) return *unsampled;
  throw Error(ErrorCode::invalid_option,
              "textures sample every set of texture coordinates; name the one to overwrite, for "
              "example texcoord=0",
              "/texcoord");
}

}  // namespace

void choose_texcoord(Gltf& gltf, const std::variant<int, TexcoordChoice>& asked) {
  const int* named = std::get_if<int>(&asked);
  gltf.is_texcoord_chosen = named == nullptr;
  const int set = named != nullptr ? *named : chosen_set(gltf, std::get<TexcoordChoice>(asked));
  gltf.texcoord = "TEXCOORD_" + std::to_string(set);
  if (named != nullptr) gltf.uvs_from = gltf.texcoord;
}

}  // namespace unwrapd::asset::reader
