#pragma once
// The distortion metrics of Sec. 6 on |sigma|, and the number of flips.

#include <span>
#include <stop_token>

#include "core/base/executor.hpp"
#include "core/measure/jacobian.hpp"
#include "core/types/report.hpp"

namespace unwrapd::measure {

/// Sums over triangles from which Distortion is computed. Those of several charts add up.
struct DistortionSums {
  double area = 0;     ///< sum of A_t
  double uv_area = 0;  ///< sum of A_t |sigma_max sigma_min|
  double measured = 0,
         measured_uv = 0;  ///< the same sums over triangles that are not degenerate, as all below
  double angle = 0;        ///< sum of A_t (sigma_max / |sigma_min| + |sigma_min| / sigma_max)
  double inverse = 0;      ///< sum of A_t / |sigma_max sigma_min|
  double stretch = 0;      ///< sum of A_t (1 / sigma_max^2 + 1 / sigma_min^2) / 2
  double collapsed = 0;    ///< measured area of maps onto a point: in no sum but angle
  Index flipped = 0;       ///< triangles with sigma_min <= 0
  Index degenerate = 0;    ///< triangles thinner than kMeasurable

  DistortionSums& operator+=(const DistortionSums& other);

  /// The sums of the same map where a unit of the mesh is `scale` units.
  [[nodiscard]] DistortionSums in_units(double scale) const;
};

/// The least height, relative to a triangle's longest side, with which it counts in D. The shape of
/// thinner triangles is rounding error (of float coordinates, say), and one of them may be
/// stretched a million times. They are counted as degenerate and belong to no mean.
inline constexpr double kMeasurable = 1e-5;

/// A collapsed image has no finite D: each singular value counts as at least this share of the root
/// mean square of all. So D_angle stays below 1.5e6, D_area below 1e12 + 1, stretch below 1e6; a
/// chart that reaches the floor shows D_angle in the thousands. A map onto a point has D_angle 1e6,
/// D_area 1e12 and stretch 1e6.
inline constexpr double kMinSingularValue = 1e-6;

/// faces index uv; rest has one entry a face. The same bits for any executor. Throws
/// Error{cancelled}.
DistortionSums distortion_sums(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                               std::span<const Vec2> uv, Executor& executor);

/// The same for all faces of a mesh, of which some may have no area and so no metric: they count as
/// degenerate.
DistortionSums distortion_sums(const TriMesh& mesh, std::span<const Vec2> uv, Executor& executor);

/// The same on the calling thread.
DistortionSums distortion_sums(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
                               std::span<const Vec2> uv, const std::stop_token& stop = {});

/// D_angle, D_area and stretch after the one global scale that makes UV area = 3D area (Sec. 6).
/// Stretch is the L2 norm of Sander et al. 2001.
Distortion distortion(const DistortionSums& sums);

/// Sum of A_t |det J|: the area that the images cover, counted with multiplicity, mesh units^2. The
/// same bits for any executor.
double uv_area(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
               std::span<const Vec2> uv, Executor& executor);
double uv_area(std::span<const RestTriangle> rest, std::span<const Triangle> faces,
               std::span<const Vec2> uv);

}  // namespace unwrapd::measure
