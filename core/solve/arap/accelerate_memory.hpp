#pragma once
// The L-BFGS memory of the last steps, and the direction that it gives.

#include <array>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/mesh/tri_mesh.hpp"

namespace unwrapd::solve::arap {

/// The gradient at a point of the descent, one entry a vertex, and its preconditioned form.
struct Slope {
  std::vector<Vec2> force;  ///< minus the gradient
  std::vector<Vec2> plain;  ///< A^-1 force: the unaccelerated step
};

/// The last kDepth steps. Sums over vertices do not depend on the executor.
class StepMemory {
 public:
  static constexpr std::size_t kDepth = 5;

  /// executor must outlive the memory.
  explicit StepMemory(Executor& executor) : executor_(executor) {}

  /// Stores the step from before to now, and swaps another vector into its place. A step along
  /// which the force does not fall is left out.
  void learn(std::vector<Vec2>& step, const Slope& before, const Slope& now);

  /// Writes the quasi-Newton direction at now, the point to which the last learnt step led. While
  /// the memory is empty, now is any point and the direction is the unaccelerated step. Returns the
  /// product of the direction with the force.
  double direct(const Slope& now, std::span<Vec2> direction) const;

  void forget() { order_.clear(); }
  [[nodiscard]] bool empty() const { return order_.empty(); }

 private:
  /// y, the fall of the force along s, is not stored; only products with it are.
  struct Pair {
    std::vector<Vec2> s, z;           // the step and A^-1 y
    double s_force = 0, z_force = 0;  // their products with the force at the point learnt last
  };
  using Table = std::array<std::array<double, kDepth>, kDepth>;
  struct Weights {
    std::array<double, kDepth> s = {}, z = {};
  };

  std::size_t free_slot();
  void multiply(const Slope& before, const Slope& now, std::size_t latest);
  [[nodiscard]] Weights recursion() const;

  Executor& executor_;
  std::array<Pair, kDepth> pairs_;
  Table s_y_ = {};                  // s_i y_j, where pair j is not older than pair i
  Table z_y_ = {};                  // y_i A^-1 y_j, symmetric
  std::vector<std::size_t> order_;  // the pairs in use, oldest first
};

}  // namespace unwrapd::solve::arap
