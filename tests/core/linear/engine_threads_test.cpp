// A factor again, on other threads, in the memory of another.
#include <gtest/gtest.h>

#include <thread>

#include "core/base/error.hpp"
#include "core/linear/engine.hpp"
#include "core/linear/solve_panels.hpp"
#include "tests/core/linear/systems.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::linear {
namespace {

/// Last block first, each on its own thread.
class ManyThreads final : public Executor {
 public:
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    std::vector<std::jthread> threads;
    for (int block = block_count; block-- > 0;) threads.emplace_back(body, block);
  }
};

/// Told to stop when the branches are done and the trunk begins.
class StoppedAfterBranches final : public Executor {
 public:
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    for (int block = 0; block < block_count; ++block) body(block);
    source_.request_stop();
  }
  [[nodiscard]] std::stop_token stop() const override { return source_.get_token(); }

 private:
  std::stop_source source_;
};

TEST(Engine, StopsInTheMiddleOfAFactorWhenTold) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(60, 9));
  const SparseMatrix lower = arap_matrix(owned.disk);
  StoppedAfterBranches stopped;
  try {
    const auto factor = try_factor(analyse(lower), lower, stopped);
    ADD_FAILURE() << "went on";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

TEST(Engine, GivesTheSameBitsAgainAndOnAnyNumberOfThreads) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(120, 9));
  const SparseMatrix lower = arap_matrix(owned.disk);
  const auto analysis = analyse(lower);
  EXPECT_GT(analysis->branches.all.size(), 8U);
  EXPECT_GT(analysis->branches.shared_count, 10U);
  const std::vector<Vec2> b = random_forces(lower, 5);
  const auto system = try_factor(analysis, lower);
  const std::vector<Vec2> expected = solution(*system, b);
  EXPECT_LT(backward_error(lower, expected, b), 1e-14);
  TwoThreads two;
  ManyThreads many;
  for (Executor* executor : {static_cast<Executor*>(&two), static_cast<Executor*>(&many)}) {
    std::vector<Vec2> x = b;
    try_factor(analysis, lower, *executor)->solve(x, *executor);
    EXPECT_EQ(x, expected);
    SparseMatrix bad = lower;
    bad.coeffRef(3000, 3000) = -1;
    EXPECT_EQ(try_factor(analysis, bad, *executor), nullptr);
  }
  std::vector<Vec2> elsewhere;  // one factor, two callers
  std::jthread([&] { elsewhere = solution(*system, b); }).join();
  EXPECT_EQ(elsewhere, expected);
}

/// Some columns, all on one side of the disk, and what lies over them.
struct Few {
  std::vector<Index> columns;
  std::vector<char> over;

  explicit Few(const Analysis& analysis) {
    for (std::size_t v = 0; v < 90; ++v) columns.push_back(analysis.nodes.position[v]);
    over = supernodes_over(analysis, columns);
  }
};

TEST(Engine, FindsAFewUnknownsByTheSupernodesOverThem) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(120, 9));
  const SparseMatrix lower = arap_matrix(owned.disk);
  const auto system = try_factor(analyse(lower), lower);
  const Supernodes& nodes = system->analysis()->nodes;
  const Few few(*system->analysis());
  std::vector<Vec2> b(nodes.order.size(), Vec2::Zero());
  for (std::size_t k = 0; k < few.columns.size(); ++k)
    b[std::size_t(few.columns[k])] = Vec2(1, double(k));
  SerialExecutor serial;
  TwoThreads two;
  std::vector<Vec2> expected = b;
  system->solve_in_order(expected, serial);
  for (Executor* executor : {static_cast<Executor*>(&serial), static_cast<Executor*>(&two)}) {
    std::vector<Vec2> x = b;
    system->descend_in_order(x, few.over, *executor);
    const Vec2 untouched(7, 7);
    const auto for_each_other = [&](auto visit) {
      for (std::size_t s = 0; s < nodes.count(); ++s)
        for (Index k = nodes.first[s]; few.over[s] == 0 && k < nodes.first[s + 1]; ++k)
          visit(x[std::size_t(k)]);
    };
    std::size_t count = 0;
    for_each_other([&](Vec2& value) { value = untouched, ++count; });
    EXPECT_GT(count, x.size() / 2);
    system->ascend_in_order(x, few.over, *executor);
    for_each_other([&](const Vec2& value) { EXPECT_EQ(value, untouched); });
    for (const Index k : few.columns) EXPECT_EQ(x[std::size_t(k)], expected[std::size_t(k)]);
  }
}

TEST(Engine, AddsUpFirstHalvesOfASolve) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(120, 9));
  const SparseMatrix lower = arap_matrix(owned.disk);
  const auto system = try_factor(analyse(lower), lower);
  const Few few(*system->analysis());
  SerialExecutor serial;
  std::vector<Vec2> x = random_forces(lower, 5), added(x.size(), Vec2::Zero());
  for (const Index k : few.columns) added[std::size_t(k)] = Vec2(3, -2);
  std::vector<Vec2> expected = x;
  for (std::size_t k = 0; k < x.size(); ++k) expected[k] += added[k];
  system->solve_in_order(expected, serial);
  system->descend_in_order(x, {}, serial);
  system->descend_in_order(added, few.over, serial);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] += added[k];
  system->ascend_in_order(x, {}, serial);
  for (std::size_t k = 0; k < x.size(); ++k)
    EXPECT_LT((x[k] - expected[k]).norm(), 1e-11 * (1 + expected[k].norm()));
}

TEST(Engine, RefillsAFactorInPlace) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(30, 10));
  SparseMatrix lower = arap_matrix(owned.disk);
  Factor factor(analyse(lower));
  const std::vector<Vec2> b = random_forces(lower, 8);
  ASSERT_TRUE(factor.refill(lower));
  const std::vector<Vec2> first = solution(factor, b);
  SparseMatrix other = lower;
  other.coeffRef(7, 7) = -1;
  EXPECT_FALSE(factor.refill(other));
  other.coeffRef(7, 7) = 100;
  ASSERT_TRUE(factor.refill(other));
  EXPECT_EQ(solution(factor, b), solution(*try_factor(analyse(other), other), b));
  EXPECT_LT(backward_error(other, solution(factor, b), b), 1e-14);
  ASSERT_TRUE(factor.refill(lower));
  EXPECT_EQ(solution(factor, b), first);
}

}  // namespace
}  // namespace unwrapd::linear
