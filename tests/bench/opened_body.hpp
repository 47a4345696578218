#pragma once
// Disks as artists cut them: a closed body whose seams run from limb to limb. Their maps without
// flips overlap where limbs fold open onto each other.

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// A ball with four to eight limbs drawn by the seed, about `faces` triangles, cut along the
/// shortest tree of edges between the limbs' tips, where vertices are two.
TriMesh opened_body(double faces, unsigned seed);

}  // namespace unwrapd::bench
