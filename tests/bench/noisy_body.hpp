#pragma once
// A closed body of genus 2 with limbs, as marching cubes or a scanner would give it: one mesh for
// every size, made of nothing but a formula.

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::bench {

/// About `faces` triangles, of which no two meet wrongly; every vertex moved along its normal by up
/// to `noise` of the mean edge's length, the same on every machine.
TriMesh noisy_body(double faces, double noise);

/// The same with three to six limbs and up to two rings drawn by the seed.
TriMesh seeded_body(double faces, double noise, unsigned seed);

}  // namespace unwrapd::bench
