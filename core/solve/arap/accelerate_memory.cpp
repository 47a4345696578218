// The two-loop recursion (Nocedal 1980) on inner products alone. With H0 = A^-1 every vector that
// it meets is a combination of the steps s, of z = A^-1 y and of the plain step, so that one sweep
// over the vertices takes all products and a second one adds up the direction: 20 sweeps less than
// the textbook's, and no solve but that of the plain step, which stays at hand to fall back on.
#include "core/solve/arap/accelerate_memory.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::solve::arap {
namespace {

constexpr std::size_t kBlock = 4096;       // vertices a block: fixed, so sums ignore the executor
constexpr double kLeastCurvature = 1e-10;  // s y against y A^-1 y; above 1 where E is convex

std::size_t block_count(std::size_t n) { return (n + kBlock - 1) / kBlock; }

std::span<const Vec2> block_of(std::span<const Vec2> x, std::size_t b) {
  return x.subspan(b * kBlock, std::min(kBlock, x.size() - b * kBlock));
}

double dot(std::span<const Vec2> a, std::span<const Vec2> b) {
  double x = 0, y = 0;
  for (std::size_t v = 0; v < a.size(); ++v) x += a[v].x() * b[v].x(), y += a[v].y() * b[v].y();
  return x + y;
}

/// dot(a, p - q)
double dot_fall(std::span<const Vec2> a, std::span<const Vec2> p, std::span<const Vec2> q) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v) sum += a[v].dot(p[v] - q[v]);
  return sum;
}

void add(double weight, std::span<const Vec2> x, std::span<Vec2> to) {
  for (std::size_t v = 0; v < x.size(); ++v) to[v] += weight * x[v];
}

}  // namespace

std::size_t StepMemory::free_slot() {
  if (order_.size() < kDepth)
    for (std::size_t slot = 0; slot < kDepth; ++slot)
      if (std::find(order_.begin(), order_.end(), slot) == order_.end()) return slot;
  const std::size_t oldest = order_.front();
  order_.erase(order_.begin());
  return oldest;
}

/// One sweep: all products with the force at now, and those of the latest pair with its own y. The
/// others with that y follow from how much the products with the force have fallen.
void StepMemory::multiply(const Slope& before, const Slope& now, std::size_t latest) {
  struct Sums {
    std::array<double, kDepth> s = {}, z = {};
    double s_y = 0, z_y = 0;
  };
  std::vector<Sums> partial(block_count(now.force.size()));
  executor_.for_each_block(static_cast<int>(partial.size()), [&](int block) {
    const auto b = static_cast<std::size_t>(block);
    Sums& sums = partial[b];
    const auto force = block_of(now.force, b), fell_from = block_of(before.force, b);
    Pair& own = pairs_[latest];
    for (std::size_t v = b * kBlock; v < b * kBlock + force.size(); ++v)
      own.z[v] = before.plain[v] - now.plain[v];
    for (const std::size_t i : order_) {
      sums.s[i] = dot(block_of(pairs_[i].s, b), force);
      sums.z[i] = dot(block_of(pairs_[i].z, b), force);
    }
    sums.s_y = dot_fall(block_of(own.s, b), fell_from, force);
    sums.z_y = dot_fall(block_of(own.z, b), fell_from, force);
  });
  Sums total;
  for (const Sums& sums : partial) {
    for (const std::size_t i : order_) total.s[i] += sums.s[i], total.z[i] += sums.z[i];
    total.s_y += sums.s_y, total.z_y += sums.z_y;
  }
  for (const std::size_t i : order_) {
    Pair& pair = pairs_[i];
    s_y_[i][latest] = std::exchange(pair.s_force, total.s[i]) - total.s[i];
    z_y_[i][latest] = std::exchange(pair.z_force, total.z[i]) - total.z[i];
    z_y_[latest][i] = z_y_[i][latest];
  }
  s_y_[latest][latest] = total.s_y;
  z_y_[latest][latest] = total.z_y;
}

void StepMemory::learn(std::vector<Vec2>& step, const Slope& before, const Slope& now) {
  const std::size_t latest = free_slot();
  order_.push_back(latest);
  pairs_[latest].s.swap(step);
  step.resize(now.force.size());
  pairs_[latest].z.resize(now.force.size());
  multiply(before, now, latest);
  if (!(s_y_[latest][latest] > kLeastCurvature * z_y_[latest][latest])) order_.pop_back();
}

StepMemory::Weights StepMemory::recursion() const {
  Weights weights;
  std::array<double, kDepth> alpha = {};
  for (auto i = order_.rbegin(); i != order_.rend(); ++i) {
    double s_q = pairs_[*i].s_force;
    for (auto j = order_.rbegin(); j != i; ++j) s_q -= alpha[*j] * s_y_[*i][*j];
    alpha[*i] = s_q / s_y_[*i][*i];
    weights.z[*i] = -alpha[*i];
  }
  for (auto i = order_.begin(); i != order_.end(); ++i) {
    double y_r = pairs_[*i].z_force;
    for (const std::size_t j : order_) y_r -= alpha[j] * z_y_[*i][j];
    for (auto j = order_.begin(); j != i; ++j) y_r += weights.s[*j] * s_y_[*j][*i];
    weights.s[*i] = alpha[*i] - y_r / s_y_[*i][*i];
  }
  return weights;
}

double StepMemory::direct(const Slope& now, std::span<Vec2> direction) const {
  const Weights weights = recursion();
  std::vector<double> partial(block_count(direction.size()));
  executor_.for_each_block(static_cast<int>(partial.size()), [&](int block) {
    const auto b = static_cast<std::size_t>(block);
    const auto plain = block_of(now.plain, b);
    const auto own = direction.subspan(b * kBlock, plain.size());
    std::copy(plain.begin(), plain.end(), own.begin());
    for (const std::size_t i : order_) {
      add(weights.s[i], block_of(pairs_[i].s, b), own);
      add(weights.z[i], block_of(pairs_[i].z, b), own);
    }
    partial[b] = dot(own, block_of(now.force, b));
  });
  double slope = 0;
  for (double p : partial) slope += p;
  return slope;
}

}  // namespace unwrapd::solve::arap
