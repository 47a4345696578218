#pragma once
// What a user can ask for. Aggregates with defaults in place; validate() is the one check.

#include <limits>
#include <optional>
#include <vector>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

enum class Method { asap, arap, hybrid, abf, linabf, cp, bff, ic, slim };
enum class InitialMap { automatic, mean_value, tutte, lscm };  ///< automatic: "auto" on the wire
enum class Pins { diameter, spectral };
enum class LambdaUnits { dimensionless, paper };
enum class SeamMode { automatic, keep, none, uv0 };  ///< automatic: "auto" on the wire
enum class Guarantee { none, flip_free, bijective };
enum class RepairMethod { untangle, virtual_boundary };  ///< how flipped triangles are turned back
enum class BoundaryShape { free, circle, square };
enum class Effort { fast, balanced, best };  ///< how much work a search for charts and places gets

/// When the iterations of ARAP, Hybrid and SLIM end.
struct Stop {
  std::optional<int> iterations =
      {};                    ///< given: so many plain ones, as in the paper (Sec. 4.4); >= 1
  double tolerance = 1e-6;   ///< else: accelerated, until the energy falls by less than this share
  int max_iterations = 500;  ///< and never more than this many, >= 1
};

/// A vertex that shall lie at a given place of the plane (Sec. 7).
struct PositionConstraint {
  Index surface = 0;                 ///< which of the asset's surfaces
  std::optional<Index> vertex = {};  ///< of that surface; without it:
  Vec3 position = Vec3::Zero();      ///< the vertex nearest to this point of space
  Vec2 uv = Vec2::Zero();  ///< in the page's coordinates, V pointing up; need not lie on the page
  double weight =
      std::numeric_limits<double>::infinity();  ///< finite: in least squares, page_constraints()
};

/// Edges at which the surface shall be cut open, or shall not: those between consecutive vertices
/// of a path.
struct SeamPath {
  Index surface = 0;            ///< which of the asset's surfaces
  std::vector<Index> vertices;  ///< of that surface, two or more; copies at a position are one
};

/// An island of the input's texture coordinates, the one that a face lies in, and where it shall
/// lie.
struct LockedIsland {
  Index surface = 0;           ///< which of the asset's surfaces
  Index face = 0;              ///< of that surface
  double turn = 0;             ///< in degrees, counterclockwise about the middle of its box; first
  Vec2 move = Vec2(0.0, 0.0);  ///< then, in UVs: 1 is the width or the height of the page

  [[nodiscard]] bool stays() const { return turn == 0 && move == Vec2(0, 0); }
  [[nodiscard]] bool has_place_of(const LockedIsland& other) const {
    return turn == other.turn && move == other.move;
  }
};

/// How packing may turn an island: as fits best; along the page by its straight sides or its
/// smallest box, in quarter turns ("90" on the wire); not at all.
enum class Rotation { any, quarter, none };

enum class WeldMode { automatic, exact, distance };  ///< automatic: "auto" on the wire

/// Which vertices at different positions are one, for topology; those at one position always are.
struct Welding {
  WeldMode mode = WeldMode::automatic;
  std::optional<double> distance = {};  ///< mesh units, >= 0; given if and only if mode is distance
};

/// What shares a page; each further page is a UDIM tile of its own.
enum class PageGroup { scene, material, mesh };

/// Whether seams of a surface with a mirror plane are symmetric.
enum class Symmetry { off, automatic };  ///< automatic: "auto" on the wire

/// Whether islands that are nearly rectangles become rectangles.
enum class Straighten { off, automatic };  ///< automatic: "auto" on the wire

/// Texels along the page's U and V.
struct PageSize {
  int width = 1024;
  int height = 1024;

  /// V of a page whose U is one unit long.
  [[nodiscard]] double aspect() const { return static_cast<double>(height) / width; }
};

/// How the size of the page is found, see UnwrapOptions::finds_page(). Unless it is given, the page
/// is square and the smallest that holds all islands at Packing::texels_per_unit: a multiple of
/// four texels, or a power of two.
enum class PageFit { given, multiple_of_four, power_of_two };

/// How islands go onto the page, or onto several: page k is the square [k, k+1] x [0, 1], UDIM tile
/// 1001 + k.
struct Packing {
  std::optional<double> texels_per_unit = {};  ///< of every island, > 0; empty: as many as fit
  int max_pages = 1;                           ///< [1, kMaxPages]; no more are taken than needed
  bool stack_identical = false;                ///< congruent islands lie on each other
  Rotation rotation = Rotation::any;           ///< of islands
  PageGroup group = PageGroup::scene;          ///< what has a page of its own
};

struct UnwrapOptions {
  Method method = Method::arap;
  double lambda = 0.1;  ///< hybrid only, >= 0: 0 is ASAP, infinity is ARAP
  std::vector<double> lambda_curve =
      {};  ///< hybrid only: these instead of lambda, one map for each
  LambdaUnits lambda_units = LambdaUnits::dimensionless;
  Stop stop = {};
  InitialMap initial = InitialMap::automatic;  ///< see initial_map()
  Pins pins = Pins::diameter;                  ///< ASAP only: how the conformal map is pinned
  SeamMode seams = SeamMode::automatic;        ///< which vertex copies are welded for topology
  std::vector<SeamPath> seam_edges = {};       ///< cuts beside those of seams
  std::vector<SeamPath> keep_edges = {};       ///< no cut that is chosen follows these (ADR 0074)
  std::optional<double> max_distortion = {};   ///< D_angle and D_area of all charts, ADR 0018
  std::optional<int> max_charts = {};  ///< of the asset, but one for each component at least
  int resolution = 1024;               ///< side of the square page, texels, [16, 16384]
  std::optional<int> width = {}, height = {};  ///< of the page, texels, in place of resolution
  PageFit page_fit = PageFit::given;
  int padding = 2;                             ///< gap between islands and to the border, texels
  Guarantee guarantee = Guarantee::flip_free;  ///< what holds of the UVs that are written
  RepairMethod repair = RepairMethod::untangle;
  BoundaryShape boundary =
      BoundaryShape::free;  ///< ASAP, ARAP, Hybrid: where the longest loop lies
  std::vector<PositionConstraint> constraints =
      {};  ///< ASAP, ARAP, Hybrid; the page is then theirs
  Packing packing = {};
  std::vector<LockedIsland> locked_islands = {};  ///< are not packed when UVs are packed anew
  bool repack_only = false;          ///< the surfaces' own UVs are packed anew, nothing is solved
  bool measure_only = false;         ///< the surfaces' own UVs are measured where they are
  Effort effort = Effort::balanced;  ///< counted work of the searches, never time (ADR 0045)
  Welding welding = {};              ///< of vertices at different positions
  Straighten straighten = Straighten::off;
  Symmetry symmetry = Symmetry::off;

  /// Whether the size follows from the density; Report::page then has it.
  [[nodiscard]] bool finds_page() const {
    return page_fit != PageFit::given && packing.texels_per_unit && !width && !height;
  }

  /// Whether the surfaces' own UVs are the maps.
  [[nodiscard]] bool keeps_uvs() const { return repack_only || measure_only; }

  [[nodiscard]] PageSize page_size() const {
    return {width.value_or(resolution), height.value_or(resolution)};
  }
};

/// The distortion up to which a surface that is no disk is taken apart when none is asked for.
inline constexpr double kDefaultDistortion = 2.02;
inline constexpr double kMinDistortion = 2.0001;

inline constexpr int kMinResolution = 16;
inline constexpr int kMaxResolution = 16384;
inline constexpr int kMaxPages = 10;  ///< a row of UDIM tiles

/// Finite weights of constraints. A vertex with weight w adds w |u - uv|^2 to the energy of its
/// chart, both in units in which the chart's surface has area 1; energies are then of the order of
/// 0.01 to 1. Beyond these bounds double precision would no longer see one beside the other.
inline constexpr double kMinConstraintWeight = 1e-9, kMaxConstraintWeight = 1e9;

/// Whether the method can hold vertices where a user wants them (constraints, boundary).
inline bool can_hold(Method method) {
  return method == Method::asap || method == Method::arap || method == Method::hybrid;
}

/// Throws Error{invalid_option} with the JSON pointer of the first option that is out of range.
void validate(const UnwrapOptions& options, int max_iterations);

}  // namespace unwrapd
