#pragma once
// MTL: the materials of an OBJ, as far as a glTF can have them.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/base/pace.hpp"

namespace unwrapd::asset::obj {

/// Paths of images are relative to the MTL, with '/' between folders. Empty: none.
struct MtlMaterial {
  std::array<double, 3> colour = {1, 1, 1};    ///< Kd, linear
  std::array<double, 3> emission = {0, 0, 0};  ///< Ke
  double alpha = 1;                            ///< d, or 1 - Tr
  double metallic = 0;                         ///< Pm
  std::optional<double> roughness = {};        ///< Pr
  double shininess = 0;                        ///< Ns
  std::string colour_map;                      ///< map_Kd
  std::string emission_map;                    ///< map_Ke
  std::string normal_map;                      ///< norm, or map_Bump where its name says so
  double normal_scale = 1;                     ///< -bm
  std::string alpha_map;                       ///< map_d
  std::vector<std::string> dropped;            ///< other statements of images: "map_ks"
};

using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

/// Adds the materials of a library; the first of a name counts. Statements that cannot be read are
/// passed over: no result depends on them but by its looks. Throws Error{cancelled}.
void read_mtl(std::string_view text, Pace& pace, MtlLibrary& library);

/// The path as a URI has it: '/' between folders, no drive, no "./"; the name alone of an absolute
/// path or one that leads out of the folder.
std::string plain_path(std::string_view path);

}  // namespace unwrapd::asset::obj
