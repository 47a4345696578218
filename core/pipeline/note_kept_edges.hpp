#pragma once
// Tells which edges that should be kept are seams in the result.

#include <optional>
#include <span>
#include <stop_token>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/note.hpp"
#include "core/types/options.hpp"

namespace unwrapd::pipeline {

/// A note with the number of edges of `kept` that are seams of the maps; none if no edge is.
/// unwrapped: one a surface. Edges at a boundary of the mesh are no seams. Throws Error{cancelled}.
std::optional<Note> note_kept_edges(std::span<const Surface> surfaces,
                                    std::span<const UnwrappedSurface> unwrapped,
                                    std::span<const SeamPath> kept, const std::stop_token& stop);

}  // namespace unwrapd::pipeline
