#pragma once
// The solver's view of a chart: a disk, which may have holes, recentred and scaled to unit area.

#include <span>
#include <stop_token>

#include "core/base/executor.hpp"
#include "core/base/shared_cache.hpp"
#include "core/linear/sparse.hpp"
#include "core/measure/rest_triangle.hpp"
#include "core/mesh/halfedges.hpp"
#include "core/mesh/shared_list.hpp"
#include "core/types/cache_key.hpp"

template <>
inline constexpr bool unwrapd::kIsPlain<unwrapd::measure::RestTriangle> =
    sizeof(unwrapd::measure::RestTriangle) == 10 * sizeof(double);

namespace unwrapd::solve {

/// Views into a chart, and its geometry in units in which the surface area is 1, so that results do
/// not depend on the scale or the position of the input. Copies share their lists.
struct Disk {
  ListView<Triangle> faces;
  ListView<BoundaryLoop> loops;  ///< the longest first
  SharedList<Vec3> positions;    ///< one a vertex, centroid at the origin
  SharedList<measure::RestTriangle>
      rest;  ///< one a face, areas add up to 1 (up to the height floor)
  linear::VertexCorners corners;
  double unit = 1;              ///< mesh units in one disk unit of length
  SharedCache* core = nullptr;  ///< shares results with other jobs; null: none
  ListView<Index> twin = {};    ///< of half-edges, as in Chart::halfedges; empty: not known
  bool is_ordered = false;  ///< vertices are numbered in a good order of elimination; core is null
  std::stop_token stop = {};  ///< cancels functions of the disk (cancel.hpp)

  [[nodiscard]] Index vertex_count() const { return static_cast<Index>(positions.size()); }
};

/// Describes all of a disk except the job that it belongs to.
void describe(CacheKey& key, const Disk& disk);

/// mesh, loops and what the executor's jobs share must outlive the disk. Every executor gives the
/// same bits. Throws Error{zero_area, cancelled}.
Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops, Executor& executor);

/// The same on the calling thread. The disk shares nothing with other jobs.
Disk make_disk(const TriMesh& mesh, std::span<const BoundaryLoop> loops,
               const std::stop_token& stop = {});

/// A map of the disk scaled so that measure::uv_area() is 1; one without area stays. Every executor
/// gives the same bits.
UvMap with_unit_area(const Disk& disk, UvMap uv, Executor& executor);
UvMap with_unit_area(const Disk& disk, UvMap uv);

}  // namespace unwrapd::solve
