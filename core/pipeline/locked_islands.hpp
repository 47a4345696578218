#pragma once
// Which islands stay where they are while others are packed (ADR 0074).

#include <span>
#include <stop_token>
#include <vector>

#include "core/charts/uv_islands.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

/// Of each surface, one an island, 1: options.locked_islands names it. all: one a surface, the
/// outlines in units of the page's width. Throws Error{invalid_option} with where =
/// "/locked_islands/<i>": a mesh or a face that is not there, or lies in no island, or an island
/// that lies on no page; Error{cancelled}.
std::vector<std::vector<char>> locked_islands(std::span<const Surface> surfaces,
                                              const std::vector<charts::UvIslands>& all,
                                              const UnwrapOptions& options,
                                              const std::stop_token& stop);

}  // namespace unwrapd::pipeline
