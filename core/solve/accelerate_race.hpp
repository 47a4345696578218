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

/// What a second start is wanted for.
enum class SecondStart {
  other_minimum,  ///< the first descent takes long, or the disk has several boundaries
  flip_free,      ///< the first descent came to rest with a few triangles flipped
};

/// Descends from the map first, unless SecondStart says otherwise to the end. Then the map that
/// second() gives is descended from in silence for as many iterations, or fewer when it falls
/// behind; the one of the lower energy goes on. Nothing of this where second() gives no map. The
/// energies told are those of the first descent up to the change; they never rise.
/// Throws Error{cancelled}, and what second() throws.
Solution run_race(const Race& race, const UvMap& first,
                  const std::function<const UvMap*(SecondStart)>& second);

}  // namespace unwrapd
