// Which maps a list of lambdas gets.
#include "core/pipeline/lambda_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <random>

namespace unwrapd::pipeline {
namespace {

constexpr double kSlack = 1e-3;

struct Case {
  std::vector<Tradeoff> candidates;
  std::size_t lambda_count = 0;
  std::vector<std::vector<double>> costs;  // of each lambda and candidate

  [[nodiscard]] std::vector<std::size_t> choose() const {
    return choose_in_order(candidates, lambda_count, kSlack,
                           [this](std::size_t k, std::size_t c) { return costs[k][c]; });
  }
  [[nodiscard]] std::vector<Tradeoff> maps(const std::vector<std::size_t>& chosen) const {
    std::vector<Tradeoff> maps;
    for (const std::size_t c : chosen) maps.push_back(candidates[c]);
    return maps;
  }
  [[nodiscard]] double cost(const std::vector<std::size_t>& chosen) const {
    double sum = 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) sum += costs[k][chosen[k]];
    return sum;
  }
};

Case random_case(std::mt19937& rng) {
  std::uniform_real_distribution<double> number(0, 1);
  Case made{.candidates = {}, .lambda_count = 2 + rng() % 3, .costs = {}};
  const std::size_t count = made.lambda_count + rng() % 3;
  for (std::size_t c = 0; c < count; ++c)  // steps so small that the slack matters
    made.candidates.push_back({2 + 0.004 * number(rng), 2 + 0.004 * number(rng),
                               c < made.lambda_count ? c : rng() % made.lambda_count});
  for (std::size_t k = 0; k < made.lambda_count; ++k) {
    made.costs.emplace_back(count);
    for (std::size_t c = 0; c < count; ++c) made.costs[k][c] = c == k ? 0 : number(rng);
  }
  return made;
}

/// Whether another candidate has no more distortion of either kind, and the pair is out of order.
bool is_excluded(const Case& of, std::size_t c) {
  const Tradeoff& own = of.candidates[c];
  return std::ranges::any_of(of.candidates, [&](const Tradeoff& other) {
    if (other.angle > own.angle || other.area > own.area) return false;
    const bool is_lower = own.lambda < other.lambda;
    return !is_ordered(std::array{is_lower ? own : other, is_lower ? other : own}, kSlack);
  });
}

/// The least cost of all choices in order, by trying all.
double least_cost(const Case& of, std::vector<std::size_t> chosen = {}) {
  if (!chosen.empty() && is_excluded(of, chosen.back()))
    return std::numeric_limits<double>::infinity();
  if (!is_ordered(of.maps(chosen), kSlack)) return std::numeric_limits<double>::infinity();
  if (chosen.size() == of.lambda_count) return of.cost(chosen);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < of.candidates.size(); ++c) {
    std::vector<std::size_t> longer = chosen;
    longer.push_back(c);
    least = std::min(least, least_cost(of, longer));
  }
  return least;
}

TEST(LambdaOrder, AChoiceIsInOrderAndNoneInOrderCostsLess) {
  std::mt19937 rng(1);
  for (int i = 0; i < 400; ++i) {
    const Case made = random_case(rng);
    const std::vector<std::size_t> chosen = made.choose();
    ASSERT_EQ(chosen.size(), made.lambda_count);
    EXPECT_TRUE(is_ordered(made.maps(chosen), kSlack)) << i;
    EXPECT_NEAR(made.cost(chosen), least_cost(made), 1e-12) << i;
  }
}

TEST(LambdaOrder, MapsInOrderStay) {
  const Case made{.candidates = {{2.01, 2.5, 0}, {2.02, 2.2, 1}, {2.02, 2.2, 2}, {2.3, 2.0, 3}},
                  .lambda_count = 4,
                  .costs = {{0, 1, 1, 1}, {1, 0, 1, 1}, {1, 1, 0, 1}, {1, 1, 1, 0}}};
  EXPECT_EQ(made.choose(), (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST(LambdaOrder, AMapThatIsWorseInBothGivesWayWhateverItCosts) {
  const Case made{.candidates = {{2.03, 2.1, 0}, {2.01, 2.05, 1}},
                  .lambda_count = 2,
                  .costs = {{0, 100}, {1e-6, 0}}};
  EXPECT_EQ(made.choose(), (std::vector<std::size_t>{1, 1}));
}

TEST(LambdaOrder, SmallStepsBackDoNotAddUp) {  // each within the slack, all together not
  std::vector<Tradeoff> maps;
  for (int k = 0; k < 4; ++k) maps.push_back({2.1 - 0.6 * kSlack * k, 2, {}});
  EXPECT_TRUE(is_ordered(std::span(maps).first(2), kSlack));
  EXPECT_FALSE(is_ordered(maps, kSlack));
}

}  // namespace
}  // namespace unwrapd::pipeline
