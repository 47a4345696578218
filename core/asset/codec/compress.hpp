#pragma once
// Compresses the geometry of a document before it is written.

#include <optional>
#include <span>
#include <string>

#include "core/asset/gltf/gltf.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::codec {

/// Compresses every primitive of indexed or plain triangles by KHR_draco_mesh_compression:
/// sequentially, so that vertices and faces keep their order. gltf: an uncompressed document.
/// with_fallback: readers without Draco still find the geometry, and the extension is not required.
/// position_bits: positions are rounded to a grid of so many bits over the box of their mesh, and
/// normals to kDracoNormalBits; texture coordinates and all else stay exact. Unset: all is exact.
PatchedDocument draco_compressed(const Gltf& gltf, bool with_fallback,
                                 std::optional<int> position_bits);

inline constexpr int kDracoNormalBits = 10;  ///< of each octahedral coordinate: 0.25 degrees

/// The most that rounding moves a coordinate of a mesh with this box: half a step, and what floats
/// add. Draco's arithmetic in them costs 3 units of 2^-23 of the box, and the result, as well as
/// positions that came in doubles, half a unit of the coordinate's last digit.
double draco_position_error(const Vec3& low, const Vec3& high, int position_bits);

/// Tells that bound for the largest mesh. origin: what positions are relative to when rounded.
Note note_on_rounding(std::span<const Surface> surfaces, const Vec3& origin, int bits);

/// The form of meshopt's compression in a document.
struct MeshoptStyle {
  std::string name = "EXT_meshopt_compression";
  bool with_fallback =
      false;  ///< includes the uncompressed bytes, and no reader needs the extension
};

/// Compresses every buffer view that has only vertices or indices by EXT_meshopt_compression, or by
/// KHR_ as style says. bytes are those of buffer 0, the only one, and become the compressed ones.
/// The corners of a triangle may be rotated, but keep their cyclic order. Throws Error{cancelled}.
void compress_views(Json& document, std::string& bytes, const MeshoptStyle& style,
                    const std::stop_token& stop);

}  // namespace unwrapd::asset::codec
