// ARAP and Hybrid measure stretch against the surface, so they must know the length of a mesh unit
// on the page. The constrained vertices determine it: a map of the free chart is aligned with them.
// If the scale were solved together with the map, the map would shrink wherever that lowers the
// energy.
#include "core/solve/constrain_chart.hpp"

#include <cassert>
#include <utility>

#include "core/base/error.hpp"
#include "core/solve/base/align_constrained.hpp"
#include "core/solve/maps/boundary_shape.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/solve.hpp"

namespace unwrapd::solve {
namespace {

constexpr int kGuideIterations = 10;

/// The rectangle around the map.
Vec2 extent(const UvMap& uv) {
  Vec2 low = uv.front(), high = uv.front();
  for (const Vec2& u : uv) low = low.cwiseMin(u), high = high.cwiseMax(u);
  return high - low;
}

}  // namespace

VertexConstraints PageFrame::to_disk(VertexConstraints page) const {
  for (HardConstraint& p : page.hard) p.at = (p.at - origin) / scale;
  for (SoftConstraint& s : page.soft) s.at = (s.at - origin) / scale;
  return page;
}

UvMap PageFrame::to_page(UvMap uv, const VertexConstraints& page) const {
  for (Vec2& u : uv) u = origin + scale * u;
  for (const HardConstraint& p : page.hard) uv[static_cast<std::size_t>(p.vertex)] = p.at;
  return uv;
}

UvMap guide_map(const Disk& disk, const UnwrapOptions& options, const std::stop_token& stop,
                Executor& executor) {
  if (options.method == Method::asap) return maps::conformal_map(disk, options.pins);
  const UnwrapOptions plain{
      .method = Method::arap, .stop = {.iterations = kGuideIterations}, .initial = options.initial};
  SolveWatch watch;
  watch.loop.stop = stop;
  return Solver(disk, plain, {}, executor).run(0, watch).uv;
}

PageFrame page_frame(const UvMap& guide, const VertexConstraints& page,
                     const UnwrapOptions& options) {
  const Alignment alignment = align(guide, page);
  if (page.count() > 1) return {alignment.to, alignment.scale};
  const PageSize page_size = options.page_size();
  const double border = 2.0 * options.padding / page_size.width;
  const Vec2 room(1 - border, page_size.aspect() - border);
  return {alignment.to, room.cwiseQuotient(extent(guide)).minCoeff()};
}

ConstrainedStart constrained_on_page(const PageFrame& frame, const UvMap& guide,
                                     const VertexConstraints& page) {
  VertexConstraints constraints = frame.to_disk(page);
  UvMap start = constrained_start(guide, constraints);
  return {std::move(constraints), std::move(start)};
}

ConstrainedStart constrained_boundary(const Disk& disk, const UnwrapOptions& options) {
  assert(options.boundary != BoundaryShape::free);
  VertexConstraints constraints{.hard = maps::boundary_points(disk, options.boundary), .soft = {}};
  if (options.boundary == BoundaryShape::square && options.guarantee != Guarantee::none &&
      maps::flattens_a_triangle(disk, constraints.hard))
    throw Error(
        ErrorCode::invalid_constraint,
        "an edge joins two vertices of one side of the square, so that triangles would have "
        "no area; choose the boundary circle, or guarantee none",
        "/boundary");
  UvMap start = maps::mean_value_map(disk, constraints.hard);
  return {std::move(constraints), std::move(start)};
}

ChartConstraints constrain_chart(const Disk& disk, const UnwrapOptions& options,
                                 VertexConstraints page, const std::stop_token& stop,
                                 Executor& executor) {
  if (!can_hold(options.method)) return {};
  if (page.empty() && options.boundary == BoundaryShape::free) return {};
  if (page.empty()) return {.constrained = constrained_boundary(disk, options)};
  const UvMap guide = guide_map(disk, options, stop, executor);
  const PageFrame frame = page_frame(guide, page, options);
  ConstrainedStart constrained = constrained_on_page(frame, guide, page);
  return {.constrained = std::move(constrained), .page = std::move(page), .frame = frame};
}

}  // namespace unwrapd::solve
