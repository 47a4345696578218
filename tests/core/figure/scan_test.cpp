// Which samples belong to a triangle: areas, edges shared by two, borders, weights.
#include "core/figure/scan.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/figure/raster.hpp"

namespace unwrapd::figure {
namespace {

constexpr int kSide = 64;  // pixels

/// How often each sample of a square picture is visited.
class Visits {
 public:
  Visits() : count_(std::size_t{kColumns} * kColumns, 0) {}

  void add(const ScreenTriangle& triangle, const SampleRange& rows = {0, kColumns}) {
    scan(triangle, rows, kColumns, [&](int row, const SampleRange& range) {
      for (int column = range.first; column < range.end; ++column) ++at(row, column);
    });
  }
  int& at(int row, int column) {
    return count_.at(static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column));
  }
  [[nodiscard]] double pixels() const {
    double sum = 0;
    for (const int count : count_) sum += count;
    return sum / (kSamples * kSamples);
  }
  [[nodiscard]] int most() const { return *std::ranges::max_element(count_); }

  static constexpr int kColumns = kSide * kSamples;

 private:
  std::vector<int> count_;
};

ScreenTriangle triangle(const Vec2& a, const Vec2& b, const Vec2& c) {
  return {snapped(a), snapped(b), snapped(c)};
}

double area(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 p = b - a, q = c - a;
  return std::abs(p.x() * q.y() - p.y() * q.x()) / 2;
}

TEST(Scan, ASquareOfWholePixelsHasItsAreaExactly) {
  Visits visits;
  visits.add(triangle({10, 20}, {30, 20}, {30, 50}));
  visits.add(triangle({10, 20}, {30, 50}, {10, 50}));
  EXPECT_EQ(visits.pixels(), 600);
  EXPECT_EQ(visits.most(), 1);
  EXPECT_EQ(visits.at(20 * kSamples, 10 * kSamples), 1);
  EXPECT_EQ(visits.at(20 * kSamples - 1, 10 * kSamples), 0);
  EXPECT_EQ(visits.at(50 * kSamples - 1, 30 * kSamples - 1), 1);
  EXPECT_EQ(visits.at(50 * kSamples - 1, 30 * kSamples), 0);
}

TEST(Scan, AnyTriangleHasItsAreaWithinHalfASampleOfItsBorder) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> place(0, kSide);
  for (int k = 0; k < 300; ++k) {
    const Vec2 a(place(rng), place(rng)), b(place(rng), place(rng)), c(place(rng), place(rng));
    Visits visits;
    visits.add(triangle(a, b, c));
    const double border = (b - a).norm() + (c - b).norm() + (a - c).norm();
    EXPECT_NEAR(visits.pixels(), area(a, b, c), border * 0.5 / kSamples + 0.1);
    EXPECT_LE(visits.most(), 1);
  }
}

TEST(Scan, AFanAboutAnyPointCoversTheSquareOnceAndWithoutGaps) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> place(0, kSide);
  const std::vector<Vec2> rim = {{0, 0},   {13, 0}, {64, 0},    {64, 7.25}, {64, 64},
                                 {33, 64}, {0, 64}, {0, 41.37}, {0, 11}};
  for (int k = 0; k < 100; ++k) {
    const Vec2 hub = k == 0 ? Vec2(32, 32) : Vec2(place(rng), place(rng));
    Visits visits;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const Vec2 &a = rim[i], &b = rim[(i + 1) % rim.size()];
      visits.add(i % 2 == 0 ? triangle(hub, a, b) : triangle(b, a, hub));  // either orientation
    }
    EXPECT_EQ(visits.pixels(), kSide * kSide) << hub.transpose();
    EXPECT_EQ(visits.most(), 1) << hub.transpose();
  }
}

TEST(Scan, EdgesThroughSamplesBelongToOneSide) {  // centres lie at odd eighths of a pixel
  const std::vector<Vec2> rim = {{0, 0},   {20.125, 0},  {64, 0}, {64, 41.375},
                                 {64, 64}, {20.125, 64}, {0, 64}, {0, 41.375}};
  Visits visits;
  for (std::size_t i = 0; i < rim.size(); ++i)
    visits.add(triangle({20.125, 41.375}, rim[i], rim[(i + 1) % rim.size()]));
  EXPECT_EQ(visits.pixels(), kSide * kSide);
  EXPECT_EQ(visits.most(), 1);
}

TEST(Scan, NothingLiesOutsideThePicture) {
  Visits visits;  // at() would throw
  visits.add(triangle({-1e9, -50}, {1e9, -50}, {30, 1e9}));
  visits.add(triangle({-3, 10}, {-1, 80}, {-2, 100}));
  visits.add(triangle({1e300, std::nan("")}, {-1e300, 5}, {20, -1e300}));
  EXPECT_LE(visits.pixels(), 3 * kSide * kSide);
}

TEST(Scan, RowsComeApartWithoutLossOrRepetition) {
  const ScreenTriangle t = triangle({3.1, 2.2}, {60.7, 17.9}, {21.3, 63.5});
  Visits whole, parts;
  whole.add(t);
  for (int row = 0; row < Visits::kColumns; row += 7) parts.add(t, {row, row + 7});
  EXPECT_EQ(parts.pixels(), whole.pixels());
  EXPECT_EQ(parts.most(), 1);
}

TEST(Scan, ATriangleWithoutAreaHasNoSamples) {
  Visits visits;
  visits.add(triangle({1, 1}, {40, 40}, {20.5, 20.5}));
  visits.add(triangle({7, 9}, {7, 9}, {7, 9}));
  EXPECT_EQ(visits.pixels(), 0);
}

TEST(Scan, WeightsSayWhereASampleIs) {
  const std::array<Vec2, 3> corner = {Vec2(2, 3), Vec2(50, 10), Vec2(20, 60)};
  for (const bool turned : {false, true}) {
    const ScreenTriangle t = turned ? triangle(corner[0], corner[2], corner[1])
                                    : triangle(corner[0], corner[1], corner[2]);
    scan(t, {0, Visits::kColumns}, Visits::kColumns, [&](int row, const SampleRange& range) {
      const std::array<double, 3> w = CornerWeights(t, row).at(range.first);
      const Vec2 place =
          w[0] * corner[0] + w[turned ? 2 : 1] * corner[1] + w[turned ? 1 : 2] * corner[2];
      EXPECT_NEAR(place.x(), (range.first + 0.5) / kSamples, 1e-9);
      EXPECT_NEAR(place.y(), (row + 0.5) / kSamples, 1e-9);
      EXPECT_TRUE(w[0] >= 0 && w[1] >= 0 && w[2] >= -1e-12);
    });
  }
}

}  // namespace
}  // namespace unwrapd::figure
