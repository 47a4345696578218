#pragma once
// Places on the page, where users give them, and places in the disk's own units, where maps are
// solved.

#include <optional>
#include <stop_token>

#include "core/base/executor.hpp"
#include "core/solve/base/disk.hpp"
#include "core/solve/base/vertex_constraints.hpp"
#include "core/types/options.hpp"

namespace unwrapd::solve {

/// page = origin + scale * u.
struct PageFrame {
  Vec2 origin = Vec2::Zero();
  double scale = 1;  ///< of the page's units in one disk unit

  [[nodiscard]] VertexConstraints to_disk(VertexConstraints page) const;

  /// The map on the page; fixed vertices exactly where page has them.
  [[nodiscard]] UvMap to_page(UvMap uv, const VertexConstraints& page) const;
};

/// The map of a chart of which nothing is held: ASAP's own for ASAP, else that of some plain ARAP
/// iterations, which tells lengths better than any map they start from. Made once, however often
/// the targets move. Throws Error{solver_failed, cancelled}.
UvMap guide_map(const Disk& disk, const UnwrapOptions& options, const std::stop_token& stop,
                Executor& executor);

/// Where on the page a chart's held vertices, page (not empty, in the page's units), put its disk:
/// the frame in which they lie as far apart as in the guide (see align()). One vertex alone tells
/// no size: the chart's bounding square then fills the page up to the padding.
PageFrame page_frame(const UvMap& guide, const VertexConstraints& page,
                     const UnwrapOptions& options);

/// page in disk units, with the guide laid on it.
ConstrainedStart constrained_on_page(const PageFrame& frame, const UvMap& guide,
                                     const VertexConstraints& page);

/// The longest loop on the shape of options.boundary, with the mean-value map inside it. On the
/// circle that is free of flips. options.boundary is not free. Throws Error{solver_failed}, and
/// Error{invalid_constraint} where a square cannot be free of flips but options.guarantee asks for
/// it.
ConstrainedStart constrained_boundary(const Disk& disk, const UnwrapOptions& options);

/// How a chart is held. All empty: it is not.
struct ChartConstraints {
  ConstrainedStart constrained;         ///< what a Solver takes
  VertexConstraints page = {};          ///< the same on the page, of position constraints
  std::optional<PageFrame> frame = {};  ///< under position constraints
};

/// By the position constraints in page, if any, else by options.boundary. Only ASAP, ARAP and
/// Hybrid hold. Throws Error{solver_failed, invalid_constraint, cancelled}.
ChartConstraints constrain_chart(const Disk& disk, const UnwrapOptions& options,
                                 VertexConstraints page, const std::stop_token& stop,
                                 Executor& executor);

}  // namespace unwrapd::solve
