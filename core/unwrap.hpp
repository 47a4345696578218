#pragma once
// The front door of core: surfaces in, texture coordinates and a report out.

#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"
#include "core/types/progress.hpp"
#include "core/types/report.hpp"

namespace unwrapd {

/// Unwraps all surfaces into one atlas in [0,1]^2 at one texel density; under position constraints
/// the charts lie where these put them instead. The same input gives the same bytes whatever the
/// executor.
/// Throws Error: invalid_option, no_triangles, zero_area, not_orientable, invalid_constraint,
/// solver_failed, guarantee_failed, cancelled.
Unwrapped unwrap(std::span<const Surface> surfaces, const UnwrapOptions& options,
                 const Progress& progress, Executor& executor);

/// One atlas for each value of options.lambda_curve, in its order, every one the same as if its
/// lambda had been asked for alone; only Report::curve, which all of them have, is more. The
/// surfaces are analysed and factored once. Without a curve: what unwrap() gives.
std::vector<Unwrapped> unwrap_curve(std::span<const Surface> surfaces, const UnwrapOptions& options,
                                    const Progress& progress, Executor& executor);

}  // namespace unwrapd
