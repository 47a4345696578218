#pragma once
// One descent, and a second from another start where the first does not come to rest soon.

#include <functional>

#include "core/solve/accelerate.hpp"

namespace unwrapd {

/// What both descents have in common. What it refers to must outlive the call.
struct Race {
  const Assembly& assembly;
  Rigidity rigidity;
  DescentOptions options;
  const LoopWatch& watch;
  Executor& executor;
};

/// Descends from the map first. When that takes long (and at once when the disk has several
/// boundaries, where the way one start goes says little), the map that second() gives is
/// descended from in silence for as many iterations, or fewer when it falls behind; the one
/// of the lower energy goes on. Nothing, where second() gives none. The energies are those of the
/// first descent up to the change; they never rise. Throws Error{cancelled}, and what second()
/// does.
Solution run_race(const Race& race, const UvMap& first,
                  const std::function<const UvMap*()>& second);

}  // namespace unwrapd
