#pragma once
// One descent, and a second one from another start if the first converges slowly.

#include <functional>

#include "core/solve/arap/accelerate.hpp"

namespace unwrapd::solve::arap {

/// The input that both descents share. It must outlive the call.
struct Race {
  const Assembly& assembly;
  Rigidity rigidity;
  DescentOptions options;
  const LoopWatch& watch;
  Executor& executor;
};

/// Descends from the map first. If its energy still falls fast after a while, also descends from
/// the map that second() returns, without reporting, for as many iterations or until it falls
/// behind; the descent of lower energy then continues. Without a second map, the first continues.
/// The reported energies are those of the first descent up to the change; they never rise. Throws
/// Error{cancelled}, and what second() throws.
Solution run_race(const Race& race, const UvMap& first,
                  const std::function<const UvMap*()>& second);

}  // namespace unwrapd::solve::arap
