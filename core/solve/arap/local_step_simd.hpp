#pragma once
// The local step of four triangles at once, one lane each. With W = [x^1 x^2]^-1 a triangle costs
// two rows of three numbers to read: J = [u^1-u^0 u^2-u^0] W, and the forces on corners 1 and 2 are
// -2 A (J - L) W^T, that on corner 0 what makes their sum vanish. Rejected: the paper's sums over
// three cotangents and edges, ten numbers a triangle and three times the time, which side by side
// in registers took as long as one after the other.

#include <cmath>

#include "core/solve/arap/local_step.hpp"

namespace unwrapd::solve::arap {

using Duo = double __attribute__((vector_size(16), aligned(8), may_alias));
using Quad = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Two faces in a register.
struct TwoLanes {
  using Lanes = Duo;
};
struct FourLanes {
  using Lanes = Quad;
};

/// Registers::Lanes is the vector of doubles of one register. Lanes only meet in sums() and in the
/// forces on one vertex, in a fixed order, so that no result depends on their number.
template <typename Registers>
class SimdLocalStep {
 public:
  /// uv, force: two numbers a vertex, as the block numbers them.
  [[gnu::always_inline]] SimdLocalStep(const double* uv, double* force, const Rigidity& rigidity)
      : uv_(uv), force_(force), rigidity_(rigidity) {}

  /// Adds the group's forces, energy and area.
  [[gnu::always_inline]] void add(const FaceGroup& group) {
    for (std::size_t k = 0; k < kFacesAbreast; k += kLanes) {
      Ends ends[2];
      gather(group, k, ends);
      fit(group, k, ends);
      scatter(group, k, ends);
    }
  }

  [[nodiscard]] [[gnu::always_inline]] LocalSums sums() const {
    const auto total = [](const Each& x) { return (x[0] + x[1]) + (x[2] + x[3]); };
    return {total(energy_), total(uv_area_)};
  }

 private:
  using Lanes = typename Registers::Lanes;
  using Each = FaceGroup::Each<double>;
  static constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(double);

  /// One lane each: u^1 - u^0 or u^2 - u^0, later the force on corner 1 or 2.
  struct Ends {
    Lanes x, y;
  };
  /// J, or J - L.
  struct Matrix {
    Lanes m00, m01, m10, m11;
  };

  [[gnu::always_inline]] static const Lanes& lanes(const Each& x, std::size_t k) {
    return *reinterpret_cast<const Lanes*>(&x[k]);
  }
  [[gnu::always_inline]] static Lanes& lanes(Each& x, std::size_t k) {
    return *reinterpret_cast<Lanes*>(&x[k]);
  }

  /// Both coordinates of a corner of face k and, in registers of four, of face k + 2.
  [[gnu::always_inline]] void load(const FaceGroup::Each<Index>& corner, std::size_t k,
                                   Lanes& to) const {
    const auto at = [&](std::size_t face) {
      return *reinterpret_cast<const Duo*>(uv_ + 2 * static_cast<std::size_t>(corner[face]));
    };
    if constexpr (kLanes == 2)
      to = at(k);
    else
      to = __builtin_shufflevector(at(k), at(k + 2), 0, 1, 2, 3);
  }

  /// {x, y} of even and of odd faces become all x and all y; twice the same gives them back.
  [[gnu::always_inline]] static void transpose(Lanes& even, Lanes& odd) {
    const Lanes a = even, b = odd;
    if constexpr (kLanes == 2) {
      even = __builtin_shufflevector(a, b, 0, 2), odd = __builtin_shufflevector(a, b, 1, 3);
    } else {
      even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
      odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    }
  }

  [[gnu::always_inline]] void gather(const FaceGroup& group, std::size_t k, Ends (&ends)[2]) const {
    Lanes even, odd;
    load(group.corner[0], k, even);
    load(group.corner[0], k + 1, odd);
    for (std::size_t i = 0; i < 2; ++i) {
      load(group.corner[i + 1], k, ends[i].x);
      load(group.corner[i + 1], k + 1, ends[i].y);
      ends[i].x -= even, ends[i].y -= odd;
      transpose(ends[i].x, ends[i].y);
    }
  }

  [[gnu::always_inline]] void push(Index vertex, const Lanes& forces, std::size_t half) {
    Duo& force = *reinterpret_cast<Duo*>(force_ + 2 * static_cast<std::size_t>(vertex));
    force += *(reinterpret_cast<const Duo*>(&forces) + half);
  }

  /// One face after the other, since lanes may share a vertex.
  [[gnu::always_inline]] void scatter(const FaceGroup& group, std::size_t k, Ends (&forces)[2]) {
    for (Ends& force : forces) transpose(force.x, force.y);
    const Lanes even = -(forces[0].x + forces[1].x), odd = -(forces[0].y + forces[1].y);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t half = lane / 2;
      const bool is_odd = lane % 2 != 0;
      push(group.corner[0][k + lane], is_odd ? odd : even, half);
      push(group.corner[1][k + lane], is_odd ? forces[0].y : forces[0].x, half);
      push(group.corner[2][k + lane], is_odd ? forces[1].y : forces[1].x, half);
    }
  }

  [[gnu::always_inline]] void fit(const FaceGroup& group, std::size_t k, Ends (&ends)[2]) {
    const Lanes &across = lanes(group.across, k), &shear = lanes(group.shear, k);
    const Lanes &up = lanes(group.up, k), &area = lanes(group.area, k);
    Matrix m{ends[0].x * across, ends[0].x * shear + ends[1].x * up,  //
             ends[0].y * across, ends[0].y * shear + ends[1].y * up};
    const Lanes determinant = m.m00 * m.m11 - m.m01 * m.m10;
    lanes(uv_area_, k) += area * (determinant < 0 ? -determinant : determinant);
    subtract_fit(group, k, m);
    lanes(energy_, k) += area * ((m.m00 * m.m00 + m.m11 * m.m11) + (m.m01 * m.m01 + m.m10 * m.m10));
    const Lanes weight = -2 * area;
    ends[0] = {weight * (m.m00 * across + m.m01 * shear),
               weight * (m.m10 * across + m.m11 * shear)};
    ends[1] = {weight * m.m01 * up, weight * m.m11 * up};
  }

  /// Subtracts the best fit from m.
  [[gnu::always_inline]] void subtract_fit(const FaceGroup& group, std::size_t k, Matrix& m) {
    const Lanes e = 0.5 * (m.m00 + m.m11), h = 0.5 * (m.m10 - m.m01);
    Each roots;
    lanes(roots, 0) = e * e + h * h;
    for (std::size_t i = 0; i < kLanes; ++i) roots[i] = std::sqrt(roots[i]);
    const Lanes q = lanes(roots, 0);
    Lanes r = 1 - Lanes{};
    if (!std::isinf(rigidity_.lambda)) hold_scale(group, k, q, r);
    const Lanes scale = r / q;
    const auto is_turned = q > 0;  // else a collapsed image: all rotations fit equally
    const Lanes a = is_turned ? scale * e : r, b = is_turned ? scale * h : Lanes{};
    m.m00 -= a, m.m11 -= a;
    m.m01 += b, m.m10 -= b;
  }

  /// Computes the best scale r and adds its energy. Newton as in hybrid_scale(); lanes that have
  /// converged wait for the others.
  [[gnu::always_inline]] void hold_scale(const FaceGroup& group, std::size_t k, const Lanes& q,
                                         Lanes& r) {
    const Lanes& area = lanes(group.area, k);
    const Lanes given = rigidity_.lambda + Lanes{};
    const Lanes lambda = area > 0 ? (rigidity_.per_area ? given / (2 * area) : given) : Lanes{};
    const Lanes w = lambda / (1 + lambda), v = 1 / (1 + lambda);
    r = 1 + (q - 1) / (1 + 2 * lambda);
    auto is_moving = r >= r;
    for (int n = 0; n < kMaxNewtonSteps && any(is_moving); ++n) {
      const Lanes g = w * r * (r * r - 1) + v * (r - q);
      const Lanes slope = w * (3 * r * r - 1) + v;
      const Lanes step = slope > 0 ? g / slope : Lanes{};
      r -= is_moving ? step : Lanes{};
      is_moving = is_moving & (step > kNewtonTolerance * r);
    }
    lanes(energy_, k) += area * lambda * (r * r - 1) * (r * r - 1);
  }

  template <typename Mask>
  [[gnu::always_inline]] static bool any(const Mask& mask) {
    bool is_any = false;
    for (std::size_t i = 0; i < kLanes; ++i) is_any = is_any || mask[i] != 0;
    return is_any;
  }

  const double* uv_;
  double* force_;
  Rigidity rigidity_;
  Each energy_{}, uv_area_{};
};

}  // namespace unwrapd::solve::arap
