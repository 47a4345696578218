#pragma once
// Islands that lie where they are wanted while others are packed (ADR 0074).

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/uv_islands.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

/// Turns and moves islands as options.locked_islands says: in `all` (one a surface; the outlines
/// are in units of the page's width) the UVs of those that do not stay, and their outlines. Returns
/// of each surface, one an island, 1: the option names it. Throws Error{invalid_option} at
/// "/locked_islands/<i>": a mesh or a face that is not there, or lies in no island, or an island
/// that would lie on no page, or that is named twice for different places; Error{cancelled}.
std::vector<std::vector<char>> lay_locked_islands(std::span<const Surface> surfaces,
                                                  const UnwrapOptions& options,
                                                  const std::stop_token& stop,
                                                  std::vector<charts::UvIslands>& all);

}  // namespace unwrapd::pipeline
