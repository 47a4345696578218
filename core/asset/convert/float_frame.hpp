#pragma once
// Where the floats of a glTF hold positions that came in doubles. Far from the origin they would
// make few points of many; so positions are written relative to a point among them, which the node
// adds again.

#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::convert {

struct FloatFrame {
  Vec3 origin = Vec3::Zero();  ///< the translation of the node
  double moved_in_place = 0;   ///< the most that floats would move a coordinate without it
  Index collapsed = 0;         ///< faces with two different corners that become one float position
};

/// The origin is zero unless floats in place move a coordinate by more than 1e-5 of the diagonal of
/// the bounding box, or collapse an edge that they hold elsewhere. Throws Error{zero_area} for a
/// mesh so small that no origin helps, and Error{cancelled}.
FloatFrame float_frame(const TriMesh& mesh, const std::stop_token& stop);

/// Says what happened: nothing, if floats hold the mesh where it is.
std::vector<Note> notes_on(const FloatFrame& frame);

}  // namespace unwrapd::asset::convert
