// L-BFGS by inner products against the textbook's update of a dense matrix.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/solve/arap/accelerate_memory.hpp"

namespace unwrapd::solve::arap {
namespace {

/// The textbook's update of the inverse Hessian (BFGS), with dense matrices.
Eigen::MatrixXd updated(const Eigen::MatrixXd& h, const Eigen::VectorXd& s,
                        const Eigen::VectorXd& y) {
  const double rho = 1 / y.dot(s);
  const Eigen::MatrixXd left =
      Eigen::MatrixXd::Identity(h.rows(), h.cols()) - rho * s * y.transpose();
  return left * h * left.transpose() + rho * s * s.transpose();
}

Eigen::VectorXd stacked(const std::vector<Vec2>& x) {
  Eigen::VectorXd v(2 * Index(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) v.segment<2>(2 * Index(i)) = x[i];
  return v;
}

TEST(StepMemory, DirectsAsDenseBfgsOverItsLastSteps) {  // Nocedal 1980
  constexpr Index n = 7;
  std::mt19937 rng(3);
  std::normal_distribution<double> any;
  const auto random_vector = [&] {
    std::vector<Vec2> x(n);
    for (Vec2& v : x) v = Vec2(any(rng), any(rng));
    return x;
  };
  const auto random_definite = [&] {
    const Eigen::MatrixXd r = Eigen::MatrixXd::NullaryExpr(2 * n, 2 * n, [&] { return any(rng); });
    return Eigen::MatrixXd(r * r.transpose() + Eigen::MatrixXd::Identity(2 * n, 2 * n));
  };
  const Eigen::MatrixXd first = random_definite(), hessian = random_definite();
  const auto unstacked = [](const Eigen::VectorXd& v) {
    std::vector<Vec2> x;
    for (Index i = 0; i < n; ++i) x.emplace_back(v.segment<2>(2 * i));
    return x;
  };
  const auto slope = [&](std::vector<Vec2> force) {
    std::vector<Vec2> plain = unstacked(first * stacked(force));
    return Slope{std::move(force), std::move(plain)};
  };
  SerialExecutor serial;
  StepMemory memory(serial);
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs;
  Slope before = slope(random_vector());
  for (int k = 0; k < 12; ++k) {
    std::vector<Vec2> step = random_vector();
    const Eigen::VectorXd s = stacked(step), y = hessian * s;
    const Slope now = slope(unstacked(stacked(before.force) - y));
    memory.learn(step, before, now);
    pairs.emplace_back(s, y);
    if (pairs.size() > StepMemory::kDepth) pairs.erase(pairs.begin());
    Eigen::MatrixXd inverse = first;
    for (const auto& [old_s, old_y] : pairs) inverse = updated(inverse, old_s, old_y);
    const Eigen::VectorXd expected = inverse * stacked(now.force);
    std::vector<Vec2> direction(n);
    const double product = memory.direct(now, direction);
    EXPECT_LT((stacked(direction) - expected).norm(), 1e-7 * expected.norm()) << k;
    EXPECT_NEAR(product / expected.dot(stacked(now.force)), 1, 1e-7);
    before = now;
  }
}

TEST(StepMemory, LeavesOutAStepAlongWhichTheForceDoesNotFall) {
  SerialExecutor serial;
  StepMemory memory(serial);
  const Slope at{{{1, 0}, {0, 1}}, {{2, 0}, {0, 2}}};
  Slope steeper = at;
  for (Vec2& f : steeper.force) f *= 3;
  for (Vec2& p : steeper.plain) p *= 3;
  std::vector<Vec2> step{{1, 0}, {0, 1}}, direction(2);
  memory.learn(step, at, steeper);
  EXPECT_TRUE(memory.empty());
  EXPECT_EQ(memory.direct(steeper, direction), 36);
  EXPECT_EQ(direction, steeper.plain);
}

}  // namespace
}  // namespace unwrapd::solve::arap
