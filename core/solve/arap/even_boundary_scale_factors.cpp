// The global step's matrix is twice L, whose boundary is natural: it solves L u = (-K, t) for any
// fluxes t through the boundary. Which of them make u level there? F t = u - mean, F being the map
// from Neumann to Dirichlet data; conjugate gradients find t, each step one solve with the factor
// that there is. On a round disk F is the inverse of |d/ds|, which Fourier series of the loop know
// and conformal maps do not change, so that is the preconditioner: 4 to 8 steps on closed shapes
// cut open, on Gargoyle and on sheets. Whatever t is, u is exact inside. (Sawhney, Crane 2017,
// Sec. 4.1, go the other way: from a factor for Dirichlet data to Neumann data.)
//
// Rejected: conjugate gradients on all of L, preconditioned by the factor (50 steps and more).
#include "core/solve/arap/even_boundary_scale_factors.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/linear/factor.hpp"
#include "core/linear/sparse.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::solve::arap {
namespace {

constexpr double kRounding = 1e-10;   // tolerated unevenness of a solve, relative
constexpr double kOfConstants = 0.5;  // the eigenvalue used for a loop's mean, where |d/ds| has 0

using linear::at;

double dot(std::span<const double> a, std::span<const double> b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void add(double factor, std::span<const double> what, std::span<double> to) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += factor * what[k];
}

void take_off_mean(std::span<double> x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  for (double& value : x) value -= mean;
}

/// |d/ds| of functions on a circle, given at the corners of a polygon of any number of sides: they
/// are taken linear along each, at twice as many places or more, a power of two.
class HalfLaplacian {
 public:
  explicit HalfLaplacian(std::size_t corner_count)
      : corners_(corner_count), grid_(std::bit_ceil(2 * corner_count)), root_(grid_.size() / 2) {
    const double step = 2 * std::numbers::pi / static_cast<double>(grid_.size());
    for (std::size_t k = 0; k < root_.size(); ++k)
      root_[k] = std::polar(1.0, -step * static_cast<double>(k));
  }

  /// x becomes the fluxes at the corners.
  void apply(std::span<double> x) {
    for (std::size_t j = 0; j < grid_.size(); ++j) {
      const auto [k, share] = place(j);
      grid_[j] = (1 - share) * x[k] + share * x[next(k)];
    }
    transform();
    const double n = static_cast<double>(grid_.size());
    for (std::size_t f = 0; f < grid_.size(); ++f) {
      const auto waves = static_cast<double>(std::min(f, grid_.size() - f));
      grid_[f] *= std::max(waves, kOfConstants) * 2 * std::numbers::pi / (n * n);
    }
    transform();  // of a real, even spectrum: its own inverse but for the direction
    std::ranges::fill(x, 0.0);
    for (std::size_t j = 0; j < grid_.size(); ++j) {
      const auto [k, share] = place((grid_.size() - j) % grid_.size());
      x[k] += (1 - share) * grid_[j].real();
      x[next(k)] += share * grid_[j].real();
    }
  }

 private:
  struct Place {
    std::size_t corner;
    double share;  ///< relative position between two samples
  };
  [[nodiscard]] Place place(std::size_t j) const {
    const std::size_t along = j * corners_;
    return {along / grid_.size(),
            static_cast<double>(along % grid_.size()) / static_cast<double>(grid_.size())};
  }
  [[nodiscard]] std::size_t next(std::size_t k) const { return k + 1 == corners_ ? 0 : k + 1; }

  /// The discrete Fourier transform of the grid (Cooley, Tukey 1965).
  void transform() {
    const std::size_t n = grid_.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
      std::size_t bit = n / 2;
      for (; (j & bit) != 0; bit /= 2) j ^= bit;
      j ^= bit;
      if (i < j) std::swap(grid_[i], grid_[j]);
    }
    for (std::size_t half = 1; half < n; half *= 2)
      for (std::size_t begin = 0; begin < n; begin += 2 * half)
        for (std::size_t k = 0; k < half; ++k) {
          const linear::Complex a = grid_[begin + k];
          const linear::Complex b = grid_[begin + half + k] * root_[k * (n / 2 / half)];
          grid_[begin + k] = a + b;
          grid_[begin + half + k] = a - b;
        }
  }

  std::size_t corners_;
  std::vector<linear::Complex> grid_, root_;
};

/// All loops of a disk, their vertices one after the other.
class Boundary {
 public:
  Boundary(const Disk& disk, std::span<const Index> rank) {
    for (const BoundaryLoop& loop : disk.loops) {
      for (const Index h : loop) rank_.push_back(rank[at(start_of(disk.faces, h))]);
      loops_.emplace_back(loop.size());
      ends_.push_back(rank_.size());
    }
  }

  [[nodiscard]] std::size_t size() const { return rank_.size(); }
  [[nodiscard]] std::span<const Index> ranks() const { return rank_; }

  /// The values at the boundary, less their mean. u: by ranks.
  [[nodiscard]] std::vector<double> unevenness(std::span<const Vec2> u) const {
    std::vector<double> values;
    values.reserve(size());
    for (const Index r : rank_) values.push_back(u[at(r)].x());
    take_off_mean(values);
    return values;
  }

  void add_fluxes(std::span<const double> flux, std::span<Vec2> to) const {
    for (std::size_t k = 0; k < flux.size(); ++k) to[at(rank_[k])].x() += flux[k];
  }

  /// Fluxes that would nearly make up for this unevenness; they add up to zero.
  [[nodiscard]] std::vector<double> precondition(std::vector<double> values) {
    std::size_t begin = 0;
    for (std::size_t l = 0; l < loops_.size(); begin = ends_[l++])
      loops_[l].apply(std::span(values).subspan(begin, ends_[l] - begin));
    take_off_mean(values);
    return values;
  }

 private:
  std::vector<Index> rank_;
  std::vector<HalfLaplacian> loops_;
  std::vector<std::size_t> ends_;
};

/// Of twice L, by ranks: -K inside, and on the boundary what makes up for all of it, evenly.
std::vector<Vec2> first_fluxes(const Disk& disk, const Boundary& boundary,
                               std::span<const Index> rank, std::span<const double> curvature) {
  std::vector<Vec2> flux(rank.size(), Vec2::Zero());
  for (std::size_t v = 0; v < rank.size(); ++v) flux[at(rank[v])].x() = -2 * curvature[v];
  double sum = 0;
  for (const BoundaryLoop& loop : disk.loops)
    for (const Index h : loop) flux[at(rank[at(start_of(disk.faces, h))])].setZero();
  for (const Vec2& f : flux) sum += f.x();
  const std::vector<double> even(boundary.size(), -sum / static_cast<double>(boundary.size()));
  boundary.add_fluxes(even, flux);
  return flux;
}

}  // namespace

std::optional<std::vector<double>> even_boundary_scale_factors(const Disk& disk,
                                                               const GlobalStep& global,
                                                               std::span<const double> curvature,
                                                               int most) {
  Boundary boundary(disk, global.rank());
  const std::vector<char> over = global.over(boundary.ranks());
  std::vector<Vec2> u = first_fluxes(disk, boundary, global.rank(), curvature), change(u.size());
  global.descend_by_rank(u, {});
  change = u;
  global.ascend_by_rank(change, over);
  std::vector<double> left = boundary.unevenness(change), all(left.size(), 0.0);
  std::vector<double> way = boundary.precondition(left);
  double slope = dot(left, way);
  const double enough = std::max(kLevel * kLevel * dot(left, left),
                                 kRounding * kRounding * static_cast<double>(boundary.size()));
  const auto descend = [&](std::span<const double> flux) {
    std::ranges::fill(change, Vec2::Zero());
    boundary.add_fluxes(flux, change);
    global.descend_by_rank(change, over);
  };
  for (int solves = 1; dot(left, left) > enough; ++solves) {
    if (solves == most) return std::nullopt;
    throw_if_cancelled(disk.stop);
    descend(way);
    global.ascend_by_rank(change, over);
    const std::vector<double> answer = boundary.unevenness(change);
    const double length = slope / dot(way, answer);
    add(length, way, all);
    add(-length, answer, left);
    std::vector<double> next = boundary.precondition(left);
    const double slope_before = std::exchange(slope, dot(left, next));
    add(slope / slope_before, way, next);
    way.swap(next);
  }
  descend(all);
  for (std::size_t r = 0; r < u.size(); ++r) u[r].x() -= change[r].x();
  global.ascend_by_rank(u, {});
  std::vector<double> by_vertex;
  by_vertex.reserve(u.size());
  for (const Index r : global.rank()) by_vertex.push_back(u[at(r)].x());
  return by_vertex;
}

}  // namespace unwrapd::solve::arap
