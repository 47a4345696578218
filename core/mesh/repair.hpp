#pragma once
// Which faces are fit to be unwrapped. The others are set aside and get their UVs at the end.

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

enum class FaceState : std::uint8_t {
  sound,
  collapsed,  ///< two corners at one position
  flat,       ///< three positions on one line, as far as doubles can tell
  duplicate,  ///< the positions and orientation of an earlier face
};

inline constexpr Index kNoFace = -1;

struct FaceStates {
  std::vector<FaceState> of;   ///< one a face
  std::vector<Index> same_as;  ///< the face that a duplicate repeats; kNoFace for all others
};

/// Which faces have no area. welded: the faces of mesh over welded vertices (see weld()).
/// Throws Error{cancelled}.
FaceStates inspect_areas(const TriMesh& mesh, std::span<const Triangle> welded,
                         const std::stop_token& stop = {});

/// Sets apart which of the sound faces are duplicates. Throws Error{cancelled}.
void find_duplicates(std::span<const Triangle> welded, Index vertex_count,
                     const std::stop_token& stop, FaceStates& states);

/// Both. welded: the faces of mesh over welded vertices (see weld()). The same triangle seen from
/// behind is no duplicate: both sides of a double-sided sheet stay.
FaceStates inspect_faces(const TriMesh& mesh, std::span<const Triangle> welded,
                         const std::stop_token& stop = {});

}  // namespace unwrapd
