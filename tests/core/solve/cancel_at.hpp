#pragma once
// Cancelling in the middle of a solve.

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::solve {

/// Runs `solve(watch)`, asks it to stop when it tells of iteration `last`, and expects the error
/// `cancelled` without another iteration.
template <class Solve>
void expect_cancelled_at(int last, Solve solve) {
  std::stop_source stop;
  SolveWatch watch;
  watch.loop.stop = stop.get_token();
  int seen = 0;
  watch.loop.on_iteration = [&](const Solution& s) {
    seen = s.iterations;
    if (seen == last) stop.request_stop();
  };
  try {
    solve(watch);
    FAIL() << "the solver did not stop";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(seen, last);
}

}  // namespace unwrapd::solve
