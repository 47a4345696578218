#pragma once
// Families of made meshes: any number of each by seed, so that nothing is tuned on named ones.

#include <string>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// "FAMILY:FACES:SEED", FAMILY one of body (a smooth closed body of random limbs and rings), noisy
/// (the same, rough), blocks (a closed hull of random cells, subdivided), boxes (a scene of boxes,
/// each a component), soup (triangles apart), hill (a bumpy disk), cap (more than half of a sphere,
/// open), torus, opened (a body cut from limb to limb to a disk), crowd (a few bodies and many
/// parts much smaller than these), kit (a floor of tiles with walls and crates on it, whose edges
/// touch), plate (with small wells, cones and domes on it). About that many faces. Empty where the
/// name is none of these.
TriMesh made_shape(const std::string& name);

}  // namespace unwrapd::bench
