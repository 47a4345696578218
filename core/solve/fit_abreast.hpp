#pragma once
// The local step of four triangles at once, one lane each. With W = [x^1 x^2]^-1 a triangle costs
// two rows of three numbers to read: J = [u^1-u^0 u^2-u^0] W, and the forces on corners 1 and 2 are
// -2 A (J - L) W^T, that on corner 0 what makes their sum vanish. Rejected: the paper's sums over
// three cotangents and edges, ten numbers a triangle and three times the time, which side by side
// in registers took as long as one after the other.

#include <cmath>

#include "core/solve/local_step.hpp"

namespace unwrapd {

struct TwoLanes {
  using Lanes = double __attribute__((vector_size(16), aligned(8), may_alias));
};
struct FourLanes {
  using Lanes = double __attribute__((vector_size(32), aligned(8), may_alias));
};

/// Registers::Lanes: the vector of doubles of one register. Lanes do not meet but in sums(), in an
/// order of their own: no result depends on their number.
template <typename Registers>
class FitAbreast {
 public:
  [[gnu::always_inline]] FitAbreast(std::span<const Vec2> uv, const Rigidity& rigidity)
      : uv_(uv), rigidity_(rigidity) {}

  /// residual: of the corners of the group's faces.
  [[gnu::always_inline]] void add(const FaceGroup& group, Vec2* residual) {
    Gathered u;
    gather(group, u);
    Forces forces;
    for (std::size_t k = 0; k < kFacesAbreast; k += kLanes) fit(group, u, k, forces);
    for (std::size_t k = 0; k < kFacesAbreast; ++k) {
      const Vec2 first(forces.x[0][k], forces.y[0][k]), second(forces.x[1][k], forces.y[1][k]);
      residual[3 * k] = -(first + second);
      residual[3 * k + 1] = first;
      residual[3 * k + 2] = second;
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

  /// u^1 - u^0 and u^2 - u^0.
  struct Gathered {
    Each x[2], y[2];
  };
  /// On corners 1 and 2.
  struct Forces {
    Each x[2], y[2];
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

  [[gnu::always_inline]] void gather(const FaceGroup& group, Gathered& u) const {
    for (std::size_t k = 0; k < kFacesAbreast; ++k) {
      const Vec2& origin = uv_[static_cast<std::size_t>(group.corner[0][k])];
      for (std::size_t i = 0; i < 2; ++i) {
        const Vec2& end = uv_[static_cast<std::size_t>(group.corner[i + 1][k])];
        u.x[i][k] = end.x() - origin.x();
        u.y[i][k] = end.y() - origin.y();
      }
    }
  }

  [[gnu::always_inline]] void fit(const FaceGroup& group, const Gathered& u, std::size_t k,
                                  Forces& forces) {
    const Lanes &across = lanes(group.across, k), &shear = lanes(group.shear, k);
    const Lanes &up = lanes(group.up, k), &area = lanes(group.area, k);
    Matrix m{lanes(u.x[0], k) * across, lanes(u.x[0], k) * shear + lanes(u.x[1], k) * up,
             lanes(u.y[0], k) * across, lanes(u.y[0], k) * shear + lanes(u.y[1], k) * up};
    const Lanes determinant = m.m00 * m.m11 - m.m01 * m.m10;
    lanes(uv_area_, k) += area * (determinant < 0 ? -determinant : determinant);
    subtract_fit(group, k, m);
    lanes(energy_, k) += area * ((m.m00 * m.m00 + m.m11 * m.m11) + (m.m01 * m.m01 + m.m10 * m.m10));
    const Lanes weight = -2 * area;
    lanes(forces.x[0], k) = weight * (m.m00 * across + m.m01 * shear);
    lanes(forces.y[0], k) = weight * (m.m10 * across + m.m11 * shear);
    lanes(forces.x[1], k) = weight * m.m01 * up;
    lanes(forces.y[1], k) = weight * m.m11 * up;
  }

  /// J becomes J - L.
  [[gnu::always_inline]] void subtract_fit(const FaceGroup& group, std::size_t k, Matrix& m) {
    const Lanes e = 0.5 * (m.m00 + m.m11), h = 0.5 * (m.m10 - m.m01);
    Each roots;
    lanes(roots, 0) = e * e + h * h;
    for (std::size_t i = 0; i < kLanes; ++i) roots[i] = std::sqrt(roots[i]);
    const Lanes q = lanes(roots, 0);
    Lanes r = 1 - Lanes{};
    if (!std::isinf(rigidity_.lambda)) hold_scale(group, k, q, r);
    const Lanes scale = r / q;
    const auto is_turned = q > 0;  // else a collapsed image: all turns fit alike
    const Lanes a = is_turned ? scale * e : r, b = is_turned ? scale * h : Lanes{};
    m.m00 -= a, m.m11 -= a;
    m.m01 += b, m.m10 -= b;
  }

  /// r becomes the best scale, its own energy is added. Newton as in hybrid_scale(): a lane that
  /// has arrived waits for the others.
  [[gnu::always_inline]] void hold_scale(const FaceGroup& group, std::size_t k, const Lanes& q,
                                         Lanes& r) {
    const Lanes& area = lanes(group.area, k);
    const Lanes given = rigidity_.lambda + Lanes{};
    const Lanes lambda = area > 0 ? (rigidity_.per_area ? given / (2 * area) : given) : Lanes{};
    const Lanes w = lambda / (1 + lambda), v = 1 / (1 + lambda);
    r = q > 1 ? q : r;
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

  std::span<const Vec2> uv_;
  Rigidity rigidity_;
  Each energy_{}, uv_area_{};
};

}  // namespace unwrapd
