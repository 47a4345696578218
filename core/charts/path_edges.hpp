#pragma once
// The edges of paths that the caller names: seams, and edges that are kept.

#include <span>
#include <string>
#include <vector>

#include "core/charts/charts.hpp"
#include "core/mesh/seams.hpp"

namespace unwrapd::charts {

/// A path as errors name it: "/seam_edges/3".
struct PathName {
  std::string option;
  std::size_t number = 0;
};

/// The edges of one path over welded vertices, ascending. first_at: see weld(). Throws
/// Error{invalid_option} at the path if it names a vertex that is not there.
std::vector<EdgeEnds> path_edges(std::span<const Index> first_at, const SeamPath& path,
                                 const PathName& name);

/// Throws Error{invalid_option} at the path: no face has this edge.
[[noreturn]] void refuse_missing(const PathName& name, const EdgeEnds& edge);

/// The edges of the surface that are kept, over welded vertices, ascending, each once. Throws
/// Error{invalid_option} with where = "/keep_edges/<i>": a vertex or an edge that is not there, or
/// an edge that is in seams.paths, too.
std::vector<EdgeEnds> kept_edges(const SeamRules& seams, std::span<const Index> first_at,
                                 std::span<const Triangle> welded);

/// Sets Chart::avoid of kept edges to kKept. Edges that are cut already are left out: there is
/// nothing to keep.
void mark_kept(std::span<const Triangle> welded, std::span<const EdgeEnds> kept, Chart& chart);

}  // namespace unwrapd::charts
