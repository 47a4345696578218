#pragma once
// Finds the faces that cannot be unwrapped. They are set aside and get UVs at the end.

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

enum class FaceState : std::uint8_t {
  sound,
  collapsed,  ///< two corners at one position
  flat,       ///< three positions on one line, to double precision
  duplicate,  ///< the same positions and orientation as an earlier face
};

inline constexpr Index kNoFace = -1;

struct FaceStates {
  std::vector<FaceState> of;   ///< one a face
  std::vector<Index> same_as;  ///< the face that a duplicate repeats; kNoFace for all others
};

/// Finds the faces without area. welded: the faces of mesh over welded vertices (see weld()).
/// Throws Error{cancelled}.
FaceStates inspect_areas(const TriMesh& mesh, std::span<const Triangle> welded,
                         const std::stop_token& stop = {});

/// Finds the duplicates among the sound faces. Throws Error{cancelled}.
void find_duplicates(std::span<const Triangle> welded, Index vertex_count,
                     const std::stop_token& stop, FaceStates& states);

/// Both of these. welded: the faces of mesh over welded vertices (see weld()). A triangle of
/// opposite orientation is no duplicate: both sides of a double-sided sheet stay.
FaceStates inspect_faces(const TriMesh& mesh, std::span<const Triangle> welded,
                         const std::stop_token& stop = {});

}  // namespace unwrapd
