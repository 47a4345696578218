#pragma once
// One descent, and a second from another start where the first will not come to rest soon.

#include <functional>

#include "core/solve/arap/accelerate.hpp"

namespace unwrapd::solve::arap {

/// What both descents have in common. What it refers to must outlive the call.
struct Race {
  const Assembly& assembly;
  Rigidity rigidity;
  DescentOptions options;
  const LoopWatch& watch;
  Executor& executor;
};

/// Descends from the map first. Where it still falls fast after a while, the map that second()
/// gives is descended from in silence for as many iterations, or fewer when it falls behind; the
/// one of the lower energy goes on. Nothing of this where second() gives no map. The energies told
/// are those of the first descent up to the change; they never rise. Throws Error{cancelled}, and
/// what second() throws.
Solution run_race(const Race& race, const UvMap& first,
                  const std::function<const UvMap*()>& second);

}  // namespace unwrapd::solve::arap
