// Fixes two pins, or finds the smallest eigenvector. The matrix is in conformal_system.cpp.
#include "core/solve/maps/conformal.hpp"

#include <cmath>
#include <complex>
#include <memory>
#include <numeric>
#include <utility>

#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/base/cached.hpp"
#include "core/solve/maps/conformal_system.hpp"

namespace unwrapd::solve::maps {
namespace {

Index pinned_start(const Disk& disk, Index h) {
  return disk.faces[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(h % 3)];
}

/// The two boundary vertices that lie farthest apart. Inner vertices make worse pins: the triangles
/// around one flip (Isis, D_angle 2.0625 against 2.0510).
std::array<Index, 2> pins_at_diameter(const Disk& disk) {
  std::vector<Index> vertex;
  std::vector<Vec3> position;
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) {
      vertex.push_back(pinned_start(disk, h));
      position.push_back(disk.positions[static_cast<std::size_t>(vertex.back())]);
    }
  const auto [a, b] = diameter(position);
  return {vertex[static_cast<std::size_t>(a)], vertex[static_cast<std::size_t>(b)]};
}

/// Pins one vertex at the origin, the other at its distance in space.
VertexConstraints pinned_at_diameter(const Disk& disk) {
  const auto [a, b] = pins_at_diameter(disk);
  const double length =
      (disk.positions[static_cast<std::size_t>(b)] - disk.positions[static_cast<std::size_t>(a)])
          .norm();
  return {.hard = {{a, Vec2::Zero()}, {b, Vec2(length, 0)}}, .soft = {}};
}

/// Inverse iteration on H x = mu B x, B the indicator of the boundary, constants projected out.
class SpectralIteration {
 public:
  explicit SpectralIteration(const Disk& disk)
      : on_boundary_(static_cast<std::size_t>(disk.vertex_count()), 0.0), stop_(disk.stop) {
    for (const BoundaryLoop& loop : disk.loops)
      for (Index h : loop) on_boundary_[static_cast<std::size_t>(pinned_start(disk, h))] = 1;
    boundary_count_ = std::accumulate(on_boundary_.begin(), on_boundary_.end(), 0.0);
    for (double softening = 0; !system_; softening = more_softening(softening)) {
      linear::ComplexMatrix shifted = conformal_matrix(disk, softening);
      for (Index v = 0; v < disk.vertex_count(); ++v)
        shifted.coeffRef(v, v) += kShift * on_boundary_[static_cast<std::size_t>(v)];
      const auto check = [&](std::size_t bytes) { check_memory(disk, bytes); };
      system_ = try_softened(shifted, softening, check, disk.stop);
    }
  }

  UvMap run(const UvMap& start) const {
    std::vector<linear::Complex> z;
    for (const Vec2& u : start) z.emplace_back(u.x(), u.y());
    normalise(z);
    for (int k = 0; k < kMaxIterations; ++k) {
      std::vector<linear::Complex> next(z.size());
      for (std::size_t v = 0; v < z.size(); ++v) next[v] = on_boundary_[v] * z[v];
      system_->solve(next, stop_);
      normalise(next);
      const double turned = 1 - std::abs(product(z, next));
      z = std::move(next);
      if (turned < kTolerance) break;
    }
    UvMap uv;
    for (const linear::Complex& x : z) uv.emplace_back(x.real(), x.imag());
    return uv;
  }

 private:
  static constexpr double kShift = 1e-9;  // makes H + shift B definite; eigenvectors are unchanged
  static constexpr double kTolerance = 1e-14;
  static constexpr int kMaxIterations = 200;

  linear::Complex product(std::span<const linear::Complex> x,
                          std::span<const linear::Complex> y) const {
    linear::Complex sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v) sum += on_boundary_[v] * std::conj(x[v]) * y[v];
    return sum;
  }

  void normalise(std::vector<linear::Complex>& z) const {
    linear::Complex mean = 0;
    for (std::size_t v = 0; v < z.size(); ++v) mean += on_boundary_[v] * z[v] / boundary_count_;
    for (linear::Complex& x : z) x -= mean;
    const double norm = std::sqrt(std::abs(product(z, z)));
    if (!(norm > 0)) throw Error(ErrorCode::solver_failed, "the spectral map collapsed to a point");
    for (linear::Complex& x : z) x /= norm;
  }

  std::vector<double> on_boundary_;
  double boundary_count_ = 0;
  std::unique_ptr<linear::HermitianSystem> system_;
  std::stop_token stop_;
};

UvMap scaled_to_unit_area(const Disk& disk, UvMap uv) {
  const double area = measure::uv_area(disk.rest, disk.faces, uv);
  if (!(area > 0) || !std::isfinite(area))
    throw Error(ErrorCode::solver_failed,
                "the conformal map collapsed; choose another method or initial map");
  const double scale = 1 / std::sqrt(area);
  for (Vec2& u : uv) u *= scale;
  return uv;
}

/// Empty if there is no exact map.
UvMap exact_map(const Disk& disk) {
  const VertexConstraints constraints = pinned_at_diameter(disk);
  const auto system = ConformalSystem::exact(disk, constraints);
  return system ? scaled_to_unit_area(disk, system->solve(constraints)) : UvMap();
}

}  // namespace

UvMap make_conformal_map(const Disk& disk, Pins pins) {
  const VertexConstraints constraints = pinned_at_diameter(disk);
  UvMap uv = ConformalSystem(disk, constraints).solve(constraints);
  if (pins == Pins::spectral) uv = SpectralIteration(disk).run(uv);
  return scaled_to_unit_area(disk, std::move(uv));
}

UvMap conformal_map(const Disk& disk, Pins pins) {
  return cached_of_disk<make_conformal_map>(disk, pins);
}

std::optional<UvMap> exact_conformal_map(const Disk& disk) {
  UvMap uv = cached_of_disk<exact_map>(disk);
  if (uv.empty()) return std::nullopt;
  return uv;
}

}  // namespace unwrapd::solve::maps
