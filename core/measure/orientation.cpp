// Exact signs by floating-point expansions: Shewchuk, "Adaptive Precision Floating-Point Arithmetic
// and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997.
//
// The determinant in plain double decides nearly always: its error is bounded by a share of the sum
// of its two products. Where that leaves doubt, it is written out as a sum of doubles that do not
// overlap, whose largest one has its sign. The intermediate stages of the paper are left out: the
// doubtful cases are too few to pay for them. Products are split by std::fma, which is exact by
// definition, whatever the compiler contracts.
#include "core/measure/orientation.hpp"

#include <array>
#include <cmath>

#include "core/base/cancel.hpp"

namespace unwrapd::measure {
namespace {

constexpr double kHalfUlp = 0x1p-53;
constexpr double kFilter = (3 + 16 * kHalfUlp) * kHalfUlp;  // Shewchuk's bound for orient2d

/// A rounded value and its rounding error: value + error is exact.
struct RoundedValue {
  double value = 0;
  double error = 0;
};

RoundedValue sum(double a, double b) {
  const double s = a + b;
  const double b_seen = s - a;
  return {s, (a - (s - b_seen)) + (b - b_seen)};
}

RoundedValue product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

/// A sum of doubles in which no two overlap, by rising magnitude.
class Expansion {
 public:
  void add(double x) {
    for (std::size_t k = 0; k < size_; ++k) {
      const RoundedValue r = sum(x, part_[k]);
      part_[k] = r.error;
      x = r.value;
    }
    part_[size_++] = x;
  }

  /// Adds a * b.
  void add_product(const RoundedValue& a, const RoundedValue& b) {
    for (double x : {a.error, a.value})
      for (double y : {b.error, b.value}) {
        const RoundedValue p = product(x, y);
        add(p.error);
        add(p.value);
      }
  }

  [[nodiscard]] int sign() const {
    for (std::size_t k = size_; k-- > 0;)
      if (part_[k] != 0) return part_[k] > 0 ? 1 : -1;
    return 0;
  }

 private:
  std::array<double, 16> part_ = {};
  std::size_t size_ = 0;
};

int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const RoundedValue acx = sum(a.x(), -c.x()), acy = sum(a.y(), -c.y());
  const RoundedValue bcx = sum(b.x(), -c.x()), bcy = sum(b.y(), -c.y());
  Expansion determinant;
  determinant.add_product(acx, bcy);
  determinant.add_product({-acy.value, -acy.error}, bcx);
  return determinant.sign();
}

}  // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double determinant = left - right;
  const double doubt = kFilter * (std::abs(left) + std::abs(right));
  if (determinant > doubt) return 1;
  if (determinant < -doubt) return -1;
  if (doubt == 0) return 0;  // both products are zero: most often at corners that triangles share
  return exact_orientation(a, b, c);
}

std::vector<Index> flipped_faces(std::span<const Triangle> faces, std::span<const Vec2> uv,
                                 const std::stop_token& stop) {
  std::vector<Index> flipped;
  for (std::size_t t = 0; t < faces.size(); ++t) {
    check_cancelled_every(t, stop);
    if (orientation(faces[t], uv) <= 0) flipped.push_back(static_cast<Index>(t));
  }
  return flipped;
}

}  // namespace unwrapd::measure
