#include "core/types/options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd {
namespace {

constexpr double kMostMove = 1000;

void require(bool holds, const std::string& what, const std::string& pointer) {
  if (!holds) throw Error(ErrorCode::invalid_option, what, pointer);
}

void require_side(int texels, const std::string& name) {
  require(texels >= kMinResolution && texels <= kMaxResolution,
          name + " must lie between " + std::to_string(kMinResolution) + " and " +
              std::to_string(kMaxResolution) + " texels",
          "/" + name);
}

std::string name_of_keeping(const UnwrapOptions& options) {
  return options.measure_only ? "measure_only" : "repack_only";
}

/// Islands that stay give the others their density, and the page its islands.
void require_locked_islands(const UnwrapOptions& options) {
  if (options.locked_islands.empty()) return;
  const Packing& packing = options.packing;
  require(options.repack_only,
          "locked_islands are islands of existing texture coordinates; send repack_only, too",
          "/locked_islands");
  const std::string given = "locked islands determine the size of all; leave out ";
  require(!packing.texels_per_unit, given + "texels_per_unit", "/texels_per_unit");
  require(packing.group == PageGroup::scene, "locked islands determine the pages; leave out group",
          "/group");
  require(!packing.stack_identical, "locked islands share no place; leave out stack_identical",
          "/stack_identical");
  for (std::size_t i = 0; i < options.locked_islands.size(); ++i) {
    const LockedIsland& island = options.locked_islands[i];
    const std::string at = "/locked_islands/" + std::to_string(i);
    require(std::abs(island.turn) <= 360, "turn must lie between -360 and 360 degrees",
            at + "/turn");
    require(std::abs(island.move.x()) <= kMostMove && std::abs(island.move.y()) <= kMostMove,
            "move must lie between -1000 and 1000 pages", at + "/move");
  }
}

/// Islands that are kept have their shapes and overlaps already.
void require_kept_islands(const UnwrapOptions& options) {
  if (!options.keeps_uvs()) return;
  const std::string name = name_of_keeping(options);
  require(!options.repack_only || !options.measure_only,
          "measure_only leaves the islands where they are; leave out repack_only", "/repack_only");
  require(options.boundary == BoundaryShape::free,
          name + " keeps the islands as they are; leave out boundary", "/boundary");
  require(options.guarantee != Guarantee::bijective,
          name + " keeps existing overlaps; leave out guarantee=bijective", "/guarantee");
  require(options.straighten == Straighten::off,
          name + " keeps the islands as they are; leave out straighten", "/straighten");
}

/// Constraints say themselves where charts lie.
void require_packing(const UnwrapOptions& options) {
  const Packing& packing = options.packing;
  const bool is_packed = options.constraints.empty();
  const std::string placed = "constraints determine where charts lie; leave out ";
  require(is_packed || !options.keeps_uvs(), placed + name_of_keeping(options),
          "/" + name_of_keeping(options));
  require(is_packed || !packing.texels_per_unit, placed + "texels_per_unit", "/texels_per_unit");
  require(is_packed || packing.max_pages == 1, placed + "max_pages", "/max_pages");
  require(is_packed || !packing.stack_identical, placed + "stack_identical", "/stack_identical");
  require(is_packed || packing.rotation == Rotation::any, placed + "rotation", "/rotation");
  const bool is_grouped = packing.group != PageGroup::scene;
  require(is_packed || !is_grouped, placed + "group", "/group");
  require(packing.max_pages == 1 || !is_grouped,
          "group determines the number of pages; leave out max_pages", "/max_pages");
  require(!packing.texels_per_unit ||
              (*packing.texels_per_unit > 0 && std::isfinite(*packing.texels_per_unit)),
          "texels_per_unit must be a finite number above 0", "/texels_per_unit");
  require(packing.max_pages >= 1 && packing.max_pages <= kMaxPages,
          "max_pages must lie between 1 and " + std::to_string(kMaxPages), "/max_pages");
}

void require_page(const UnwrapOptions& options) {
  const PageSize page = options.page_size();
  require_side(options.resolution, "resolution");
  require_side(page.width, "width");
  require_side(page.height, "height");
  const int shorter = options.finds_page() ? kMaxResolution : std::min(page.width, page.height);
  require(options.padding >= 0 && 4 * options.padding <= shorter,
          "padding must lie between 0 and a quarter of the page's shorter side", "/padding");
}

/// Constraints and boundary shapes are about components that stay whole.
void require_charts(const UnwrapOptions& options) {
  require(!options.max_distortion ||
              (*options.max_distortion >= kMinDistortion && std::isfinite(*options.max_distortion)),
          "max_distortion must be a number of at least 2.0001; 2 means no distortion",
          "/max_distortion");
  require(!options.max_distortion || !keeps_whole(options),
          "max_distortion can split a mesh into charts, which constraints and a boundary shape "
          "exclude; leave one of them out",
          "/max_distortion");
  require(!options.max_charts || *options.max_charts >= 1, "max_charts must be at least 1",
          "/max_charts");
  for (std::size_t k = 0; k < options.seam_edges.size(); ++k)
    require(options.seam_edges[k].vertices.size() >= 2,
            "a path of seam_edges needs at least two vertices",
            "/seam_edges/" + std::to_string(k) + "/vertices");
}

/// An edge with the number of its path.
using PathEdge = std::pair<std::array<Index, 3>, std::size_t>;

std::vector<PathEdge> edges_of(const std::vector<SeamPath>& paths) {
  std::vector<PathEdge> edges;
  for (std::size_t p = 0; p < paths.size(); ++p)
    for (std::size_t k = 1; k < paths[p].vertices.size(); ++k) {
      const auto ends = std::minmax(paths[p].vertices[k - 1], paths[p].vertices[k]);
      edges.push_back({{paths[p].surface, ends.first, ends.second}, p});
    }
  return edges;
}

/// Copies of a vertex are known once the mesh is: charts::kept_edges() refuses these.
void require_kept_edges(const UnwrapOptions& options) {
  for (std::size_t k = 0; k < options.keep_edges.size(); ++k)
    require(options.keep_edges[k].vertices.size() >= 2,
            "a path of keep_edges needs at least two vertices",
            "/keep_edges/" + std::to_string(k) + "/vertices");
  if (options.keep_edges.empty() || options.seam_edges.empty()) return;
  std::vector<PathEdge> cut = edges_of(options.seam_edges);
  std::ranges::sort(cut);
  for (const auto& [edge, path] : edges_of(options.keep_edges)) {
    const auto at = std::ranges::lower_bound(cut, edge, {}, &PathEdge::first);
    if (at == cut.end() || at->first != edge) continue;
    require(false,
            "the edge between vertices " + std::to_string(edge[1]) + " and " +
                std::to_string(edge[2]) + " is in seam_edges/" + std::to_string(at->second) +
                ", too; leave it out of one of them",
            "/keep_edges/" + std::to_string(path));
  }
}

void require_welding(const Welding& welding) {
  const bool is_given = welding.distance.has_value();
  require(welding.mode != WeldMode::distance || is_given,
          "weld=distance needs weld_distance, a length in the mesh's units", "/weld_distance");
  require(welding.mode == WeldMode::distance || !is_given, "weld_distance needs weld=distance",
          "/weld");
  require(!is_given || (*welding.distance >= 0 && std::isfinite(*welding.distance)),
          "weld_distance must be a finite number of at least 0", "/weld_distance");
}

}  // namespace

void validate(const UnwrapOptions& options, int max_iterations) {
  require(options.lambda >= 0 && !std::isnan(options.lambda),
          "lambda must be a number of at least 0", "/lambda");
  for (double lambda : options.lambda_curve)
    require(lambda >= 0 && !std::isnan(lambda), "every lambda must be a number of at least 0",
            "/lambda");
  const Stop& stop = options.stop;
  const std::string range = "between 1 and " + std::to_string(max_iterations);
  require(!stop.iterations || (*stop.iterations >= 1 && *stop.iterations <= max_iterations),
          "stop.iterations must lie " + range, "/stop/iterations");
  require(stop.max_iterations >= 1 && stop.max_iterations <= max_iterations,
          "stop.max_iterations must lie " + range, "/stop/max_iterations");
  require(stop.tolerance > 0 && stop.tolerance < 1, "stop.tolerance must lie between 0 and 1",
          "/stop/tolerance");
  require(options.constraints.empty() || can_hold(options.method),
          "constraints need method asap, arap or hybrid", "/constraints");
  require(options.constraints.empty() || options.boundary == BoundaryShape::free,
          "constraints and a boundary shape exclude each other; leave one of them out",
          "/boundary");
  require_kept_islands(options);
  require_locked_islands(options);
  const bool is_straightened = options.straighten != Straighten::off;
  require(!is_straightened || options.constraints.empty(),
          "constraints determine the maps; leave out straighten", "/straighten");
  require(!is_straightened || !shapes_boundary(options),
          "boundary determines the shape of charts; leave out straighten", "/straighten");
  require_packing(options);
  require_welding(options.welding);
  require_charts(options);
  require_kept_edges(options);
  require_page(options);
}

}  // namespace unwrapd
