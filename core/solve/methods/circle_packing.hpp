#pragma once
// A circle packing metric: one circle about each vertex; circles of neighbours cross at fixed
// angles.

#include <array>
#include <span>
#include <vector>

#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::methods {

/// Thurston's circle packing metric. The length of an edge between circles of radii r, s is l^2 =
/// r^2 + s^2 + 2 c r s, where c in [0, 1] is the cosine of the angle at which they cross. All radii
/// > 0 give lengths that satisfy the triangle inequality.
struct CirclePacking {
  std::vector<double> log_radius;               ///< one a vertex
  std::vector<std::array<double, 3>> crossing;  ///< c of each side of each face
};

/// The packing whose lengths are nearest to those of the disk: least squares of relative errors.
CirclePacking circle_packing(const Disk& disk);

/// The angles of a packing and their derivatives.
struct PackedAngles {
  std::vector<std::array<double, 3>> angle;  ///< at the corners of each face, radians
  std::vector<double> weight;                ///< 3 a face, one a side, >= 0: d angle / d log radius
  std::vector<double> curvature;             ///< one a vertex, as curvature() of metric.hpp
};

/// The graph Laplacian of `weight` is the Jacobian of the curvature by the logarithms of the radii.
PackedAngles packed_angles(const Disk& disk, const CirclePacking& packing);

}  // namespace unwrapd::solve::methods
