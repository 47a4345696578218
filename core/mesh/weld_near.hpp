#pragma once
// Welds vertices that are near each other but not at one position, where that closes a surface.

#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/edges.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

/// The greatest tolerance that is taken from the data, relative to the bounding box's diagonal.
inline constexpr double kMostTolerance = 1e-5;

/// A surface after weld() and inspect_areas().
struct WeldedFaces {
  const TriMesh& mesh;
  std::span<const Triangle> faces;  ///< over welded vertices
  const FaceStates& states;
  const std::vector<EdgeSide>& sides;  ///< of the sound faces, sorted by edge
};

/// For each vertex the one that it is welded to, the lowest of its set. Entries of vertices that no
/// face of `in` has are their own numbers. Empty if nothing is welded.
/// distance: the tolerance in mesh units, >= 0; without it, one is found from the distances, see
/// the source. Two vertices are welded only if they are ends of two open edges that then coincide,
/// and never if that would collapse a sound face. Throws Error{cancelled}.
std::vector<Index> weld_near(const WeldedFaces& in, std::optional<double> distance,
                             const std::stop_token& stop = {});

}  // namespace unwrapd
