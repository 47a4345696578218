#pragma once
// What a stored mesh is, for its owner.

#include <cstddef>
#include <string>

#include "server/work/rendering.hpp"

namespace unwrapd::server::work {

/// JSON: {"analysis": {...}}, or {"problem": {...}}, that which a job on this mesh with the usual
/// options would begin with. memory_bytes: that a job may take. Throws Error{cancelled}.
std::string mesh_analysis(const RenderingInput& mesh, std::size_t memory_bytes,
                          const api::Limits& limits);

}  // namespace unwrapd::server::work
