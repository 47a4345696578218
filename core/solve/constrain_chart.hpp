#pragma once
// Converts between the page, where users give positions, and the disk's own units, in which maps
// are solved; and constrains charts.

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
  double scale = 1;  ///< page units in one disk unit

  [[nodiscard]] VertexConstraints to_disk(VertexConstraints page) const;

  /// The map on the page. Hard-constrained vertices lie exactly where page has them.
  [[nodiscard]] UvMap to_page(UvMap uv, const VertexConstraints& page) const;
};

/// The map of a chart without constraints. For ASAP it is ASAP's own map, else the map after some
/// unaccelerated ARAP iterations, whose lengths are better than those of any initial map. It does
/// not depend on the targets. Throws Error{solver_failed, cancelled}.
UvMap guide_map(const Disk& disk, const UnwrapOptions& options, const std::stop_token& stop,
                Executor& executor);

/// The frame in which the constrained vertices have the same spread as in the guide (see align()).
/// page is not empty and in page units. A single vertex determines no size: the chart's bounding
/// square then fills the page up to the padding.
PageFrame page_frame(const UvMap& guide, const VertexConstraints& page,
                     const UnwrapOptions& options);

/// The constraints of page in disk units, and the guide aligned with them as the start.
ConstrainedStart constrained_on_page(const PageFrame& frame, const UvMap& guide,
                                     const VertexConstraints& page);

/// Places the longest loop on the shape of options.boundary, which is not free, and maps the inside
/// by mean-value coordinates. On the circle that map has no flips. Throws Error{solver_failed}, and
/// Error{invalid_constraint} if options.guarantee forbids flips and the square forces some.
ConstrainedStart constrained_boundary(const Disk& disk, const UnwrapOptions& options);

/// The constraints of a chart; all members are empty if it has none.
struct ChartConstraints {
  ConstrainedStart constrained;         ///< the input of a Solver
  VertexConstraints page = {};          ///< position constraints in page units
  std::optional<PageFrame> frame = {};  ///< set if there are position constraints
};

/// Uses the position constraints in page, if any, else options.boundary. Only ASAP, ARAP and Hybrid
/// accept constraints. Throws Error{solver_failed, invalid_constraint, cancelled}.
ChartConstraints constrain_chart(const Disk& disk, const UnwrapOptions& options,
                                 VertexConstraints page, const std::stop_token& stop,
                                 Executor& executor);

}  // namespace unwrapd::solve
