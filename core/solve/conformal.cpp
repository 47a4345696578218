// The conformal energy is Hermitian in z = u_x + i u_y, n by n instead of 2n by 2n:
//   4 E(z) = z* H z,  H = L - 4 M,
// L the cotangent Laplacian (z* L z = 2 sum A_t |J_t|^2) and M the area form (z* M z = sum of
// A_t det J_t), which only lives on the boundary: each boundary half-edge (i, j), the surface to
// its left, adds Im(conj(z_i) z_j) / 2.
#include "core/solve/conformal.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "core/error.hpp"
#include "core/linear/eliminate.hpp"
#include "core/linear/factor.hpp"
#include "core/measure/distortion.hpp"

namespace unwrapd {
namespace {

constexpr Complex kI(0, 1);

/// Bending a ribbon a million times longer than wide costs less energy than rounding: H is then
/// indefinite in double precision. Some of L, which holds lengths, makes it definite again.
constexpr double kLeastSoftening = 1e-12, kMostSoftening = 1e-2;

std::pair<Index, Index> ends(const Disk& disk, Index h) {
  const Triangle& face = disk.faces[static_cast<std::size_t>(h / 3)];
  return {face[static_cast<std::size_t>(h % 3)], face[static_cast<std::size_t>((h + 1) % 3)]};
}

/// The lower triangle of H + softening L.
ComplexMatrix conformal_matrix(const Disk& disk, double softening = 0) {
  std::vector<double> weight;
  weight.reserve(3 * disk.rest.size());
  for (const RestTriangle& rest : disk.rest)
    for (double cot : rest.cot) weight.push_back((1 + softening) * cot);
  ComplexMatrix lower = lower_laplacian(disk.faces, disk.vertex_count(), weight).cast<Complex>();
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) {
      const auto [i, j] = ends(disk, h);
      if (i > j)
        lower.coeffRef(i, j) += kI;  // H_ij += i
      else
        lower.coeffRef(j, i) -= kI;  // H_ji = conj(H_ij)
    }
  return lower;
}

/// The two boundary vertices that lie farthest apart. Inner vertices make worse pins: the triangles
/// around one flip (Isis, D_angle 2.0625 against 2.0510).
std::array<Index, 2> pins_at_diameter(const Disk& disk) {
  std::vector<Index> vertex;
  std::vector<Vec3> position;
  for (const BoundaryLoop& loop : disk.loops)
    for (Index h : loop) {
      vertex.push_back(ends(disk, h).first);
      position.push_back(disk.positions[static_cast<std::size_t>(vertex.back())]);
    }
  const auto [a, b] = diameter(position);
  return {vertex[static_cast<std::size_t>(a)], vertex[static_cast<std::size_t>(b)]};
}

/// As try_factor(), but throws when there is nothing left to try.
std::unique_ptr<HermitianSystem> try_softened(const ComplexMatrix& lower, double softening) {
  return softening < kMostSoftening ? try_factor(lower) : factor(lower);
}

/// Nothing when H is not definite in double precision and must not be softened.
std::vector<Complex> solve_pinned(const Disk& disk, bool may_soften) {
  const auto n = static_cast<std::size_t>(disk.vertex_count());
  const auto [a, b] = pins_at_diameter(disk);
  std::vector<Complex> z(n);
  z[static_cast<std::size_t>(b)] =
      (disk.positions[static_cast<std::size_t>(b)] - disk.positions[static_cast<std::size_t>(a)])
          .norm();
  std::vector<char> fixed(n, 0);
  fixed[static_cast<std::size_t>(a)] = fixed[static_cast<std::size_t>(b)] = 1;
  const FreeVertices free = number_free(fixed);
  const auto reduce = [&](double softening) {
    return eliminate<ComplexMatrix, Complex>(conformal_matrix(disk, softening), free, z);
  };
  auto reduced = reduce(0);
  std::unique_ptr<HermitianSystem> system = try_factor(reduced.lower);
  if (!system && !may_soften) return {};
  for (double softening = kLeastSoftening; !system; softening *= 100)
    reduced = reduce(softening), system = try_softened(reduced.lower, softening);
  system->solve(reduced.rhs);
  for (std::size_t v = 0; v < n; ++v)
    if (free.slot[v] != kFixed) z[v] = reduced.rhs[static_cast<std::size_t>(free.slot[v])];
  return z;
}

/// Inverse iteration on H x = mu B x, B the indicator of the boundary, constants projected out.
class SpectralIteration {
 public:
  explicit SpectralIteration(const Disk& disk)
      : on_boundary_(static_cast<std::size_t>(disk.vertex_count()), 0.0) {
    for (const BoundaryLoop& loop : disk.loops)
      for (Index h : loop) on_boundary_[static_cast<std::size_t>(ends(disk, h).first)] = 1;
    boundary_count_ = std::accumulate(on_boundary_.begin(), on_boundary_.end(), 0.0);
    for (double softening = 0; !system_; softening = std::max(100 * softening, kLeastSoftening)) {
      ComplexMatrix shifted = conformal_matrix(disk, softening);
      for (Index v = 0; v < disk.vertex_count(); ++v)
        shifted.coeffRef(v, v) += kShift * on_boundary_[static_cast<std::size_t>(v)];
      system_ = try_softened(shifted, softening);
    }
  }

  std::vector<Complex> run(std::vector<Complex> z) const {
    normalise(z);
    for (int k = 0; k < kMaxIterations; ++k) {
      std::vector<Complex> next(z.size());
      for (std::size_t v = 0; v < z.size(); ++v) next[v] = on_boundary_[v] * z[v];
      system_->solve(next);
      normalise(next);
      const double turned = 1 - std::abs(product(z, next));
      z = std::move(next);
      if (turned < kTolerance) break;
    }
    return z;
  }

 private:
  static constexpr double kShift = 1e-9;  // makes H + shift B definite; eigenvectors are unchanged
  static constexpr double kTolerance = 1e-14;
  static constexpr int kMaxIterations = 200;

  Complex product(std::span<const Complex> x, std::span<const Complex> y) const {
    Complex sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v) sum += on_boundary_[v] * std::conj(x[v]) * y[v];
    return sum;
  }

  void normalise(std::vector<Complex>& z) const {
    Complex mean = 0;
    for (std::size_t v = 0; v < z.size(); ++v) mean += on_boundary_[v] * z[v] / boundary_count_;
    for (Complex& x : z) x -= mean;
    const double norm = std::sqrt(std::abs(product(z, z)));
    if (!(norm > 0)) throw Error(ErrorCode::solver_failed, "the spectral map collapsed to a point");
    for (Complex& x : z) x /= norm;
  }

  std::vector<double> on_boundary_;
  double boundary_count_ = 0;
  std::unique_ptr<HermitianSystem> system_;
};

UvMap scaled_to_unit_area(const Disk& disk, std::span<const Complex> z) {
  UvMap uv;
  uv.reserve(z.size());
  for (const Complex& x : z) uv.emplace_back(x.real(), x.imag());
  const double area = uv_area(disk.rest, disk.faces, uv);
  if (!(area > 0) || !std::isfinite(area))
    throw Error(ErrorCode::solver_failed,
                "the conformal map collapsed; choose another method or initial map");
  const double scale = 1 / std::sqrt(area);
  for (Vec2& u : uv) u *= scale;
  return uv;
}

}  // namespace

UvMap conformal_map(const Disk& disk, Pins pins) {
  std::vector<Complex> z = solve_pinned(disk, true);
  if (pins == Pins::spectral) z = SpectralIteration(disk).run(std::move(z));
  return scaled_to_unit_area(disk, z);
}

std::optional<UvMap> exact_conformal_map(const Disk& disk) {
  const std::vector<Complex> z = solve_pinned(disk, false);
  if (z.empty()) return std::nullopt;
  return scaled_to_unit_area(disk, z);
}

}  // namespace unwrapd
