#pragma once
// What a user can ask of the document itself: which of it is unwrapped, where the texture
// coordinates go, how the result is encoded.

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/types/options.hpp"

namespace unwrapd {

/// How the geometry of a glTF is encoded when it is written.
enum class Compression {
  keep,     ///< as it came in
  none,     ///< plain accessors
  draco,    ///< KHR_draco_mesh_compression, positions and normals rounded as draco_bits says
  meshopt,  ///< EXT_meshopt_compression, lossless
};

inline constexpr int kMaxTexcoord = 7;
inline constexpr int kMinDracoBits = 8, kMaxDracoBits = 22;
inline constexpr std::size_t kMaxNames = 1000;  ///< entries of materials and of primitives

/// How the set of texture coordinates to write is chosen where none is named. Other than with a
/// named set, existing UVs are then read from TEXCOORD_0.
enum class TexcoordChoice {
  automatic,  ///< 0 unless a material of what is unwrapped samples it, else as `free`; where
              ///< textures are transferred, the first set that a material samples
  free,       ///< the first set that no material samples, and that nothing unwrapped has
};

/// What becomes of images that sample the set of texture coordinates that is written.
enum class TextureMode {
  keep,      ///< they stay as they are
  transfer,  ///< they are painted anew for the new coordinates
};

struct AssetOptions {
  /// The set that is written, and read: n of TEXCOORD_n in [0, kMaxTexcoord].
  std::variant<int, TexcoordChoice> texcoord = 0;
  Compression compression = Compression::keep;
  /// Positions in [kMinDracoBits, kMaxDracoBits] where compression is draco; unset: lossless.
  std::optional<int> draco_bits = {};
  TextureMode textures = TextureMode::keep;
  PageSize page = {};       ///< that islands are packed for: the least size of a new texture
  bool vertex_map = false;  ///< the report tells which vertices were copied
  /// Names of materials, and JSON pointers of primitives ("/meshes/0/primitives/1"): only these are
  /// unwrapped, all others keep what they have. Both empty: everything is.
  std::vector<std::string> materials = {};
  std::vector<std::string> primitives = {};
  /// Vertex attributes that fill the field of Surface of the same name: "_AVOID", "COLOR_0",
  /// "COLOR_0.r"; unset: none.
  std::optional<std::string> seam_avoid = {}, texel_density = {};
};

/// Which vertices of a primitive, or of an OBJ's mesh, are copies: 0 .. kept - 1 are what they were
/// in the input; kept + k is a copy of the input's vertex copies[k].
struct VertexMap {
  std::string where;  ///< JSON pointer of the primitive or mesh, or "obj"
  std::int64_t kept = 0;
  std::vector<std::int32_t> copies = {};
};

}  // namespace unwrapd
