#include "core/pack/mask.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/pack/occupancy.hpp"

namespace unwrapd::pack {
namespace {

/// A star with n spikes, round the origin; hollow between them.
charts::Outline star(std::mt19937& rng, int n, double radius) {
  std::uniform_real_distribution<double> share(0.2, 1);
  UvMap points;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * k / n, r = radius * share(rng);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  charts::Outline outline;
  for (std::size_t k = 0; k < points.size(); ++k)
    outline.push_back({points[k], points[(k + 1) % points.size()]});
  return outline;
}

bool has(const Rows& rows, int x, int y) {
  if (y < 0 || y >= rows.height()) return false;
  const auto row = rows.row(y);
  return std::any_of(row.begin(), row.end(),
                     [&](const Run& run) { return run.begin <= x && x < run.end; });
}

int winding(const charts::Outline& outline, const Vec2& p) {
  int sum = 0;
  for (const auto& [a, b] : outline) {
    const double side = (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
    if (a.y() <= p.y() && b.y() > p.y() && side > 0) ++sum;
    if (b.y() <= p.y() && a.y() > p.y() && side < 0) --sum;
  }
  return sum;
}

TEST(Mask, HasEveryCellInWhichThereIsAPointOfTheIsland) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> at(-20, 20);
  for (int k = 0; k < 30; ++k) {
    const charts::Outline outline = star(rng, 5 + k % 9, 20);
    const Mask mask = make_mask(outline, {}, 2);
    for (int sample = 0; sample < 400; ++sample) {
      const Vec2 p(at(rng), at(rng)), cell = p - mask.low;
      if (winding(outline, p) == 0) continue;
      EXPECT_TRUE(has(mask.touched, int(std::floor(cell.x())), int(std::floor(cell.y()))));
    }
    for (const auto& [a, b] : outline)
      for (double t = 0; t < 1; t += 0.01) {
        const Vec2 cell = a + t * (b - a) - mask.low;
        EXPECT_TRUE(has(mask.touched, std::min(int(cell.x()), mask.width - 1),
                        std::min(int(cell.y()), mask.touched.height() - 1)));
      }
  }
}

TEST(Mask, LeavesHollowsAndHolesFree) {
  const charts::Outline frame{{Vec2(0, 0), Vec2(10, 0)},        {Vec2(10, 0), Vec2(10, 10)},
                              {Vec2(10, 10), Vec2(0, 10)},      {Vec2(0, 10), Vec2(0, 0)},
                              {Vec2(2.5, 2.5), Vec2(2.5, 7.5)}, {Vec2(2.5, 7.5), Vec2(7.5, 7.5)},
                              {Vec2(7.5, 7.5), Vec2(7.5, 2.5)}, {Vec2(7.5, 2.5), Vec2(2.5, 2.5)}};
  const Mask mask = make_mask(frame, {}, 0);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x)
      EXPECT_EQ(has(mask.touched, x, y), x < 3 || x > 6 || y < 3 || y > 6) << x << ' ' << y;
}

TEST(Mask, GrowsByWhatIsNearerThanThePaddingBruteForce) {
  std::mt19937 rng(2);
  for (int padding : {1, 2, 5}) {
    const Mask mask = make_mask(star(rng, 7, 12), {.cosine = 0.6, .sine = 0.8}, padding);
    const int h = mask.touched.height();
    for (int y = -padding; y < h + padding; ++y)
      for (int x = -padding; x < mask.width + padding; ++x) {
        bool near = false;
        for (int v = 0; v < h; ++v)
          for (int u = 0; u < mask.width; ++u)
            near = near || (has(mask.touched, u, v) &&
                            std::hypot(std::max(0, std::abs(u - x) - 1),
                                       std::max(0, std::abs(v - y) - 1)) < padding);
        EXPECT_EQ(has(mask.grown, x + padding, y + padding), near)
            << padding << ": " << x << ' ' << y;
      }
  }
}

TEST(Occupancy, FindsTheLeftmostFreePlaceBruteForce) {
  std::mt19937 rng(3);
  const int width = 400, side = 100, padding = 2;  // cells
  Occupancy page(width, side, padding, width);
  std::vector<char> taken(std::size_t(side * width), 0);
  const auto fits = [&](const Mask& mask, int x, int y) {
    for (int v = -padding; v < mask.touched.height() + padding; ++v)
      for (int u = -padding; u < mask.width + padding; ++u) {
        const bool on_page = x + u >= 0 && x + u < width && y + v >= 0 && y + v < side;
        if (on_page && has(mask.grown, u + padding, v + padding) &&
            taken[std::size_t((y + v) * width + x + u)])
          return false;
      }
    return true;
  };
  for (int k = 0; k < 200; ++k) {
    const Mask mask = make_mask(star(rng, 6, 4 + k % 11), {}, padding);
    int from = k % 2 == 0 ? 0 : int(rng() % width);
    std::optional<int> found;
    int y = int(rng() % 80);  // and up, since what refused one row of places is tested first above
    for (;; ++y, from = 0) {
      found = page.first_free(mask, y, from);
      int expected = from;
      while (expected + mask.width <= width && !fits(mask, expected, y)) ++expected;
      const bool any = expected + mask.width <= width && y + mask.touched.height() <= side;
      ASSERT_EQ(found, any ? std::optional(expected) : std::nullopt) << k << ", row " << y;
      if (any || y + mask.touched.height() > side) break;
    }
    if (!found) continue;
    page.stamp(mask, *found, y);
    for (int v = 0; v < mask.touched.height(); ++v)
      for (int u = 0; u < mask.width; ++u)
        if (has(mask.touched, u, v)) taken[std::size_t((y + v) * width + *found + u)] = 1;
  }
  for (int y = -2; y < side + 2; ++y)
    for (int x = -2; x < width + 2; ++x) {
      const bool beside = x < 0 || x >= width || y < 0;
      const bool expected = y < side && (beside || taken[std::size_t(y * width + x)] != 0);
      ASSERT_EQ(page.is_taken(x, y), expected) << x << ' ' << y;
    }
}

}  // namespace
}  // namespace unwrapd::pack
