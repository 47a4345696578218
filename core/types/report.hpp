#pragma once
// What was done and how good it is: plain figures, measured on the UVs that are handed out.
// Lengths are in units of the scene (Surface::scale), D has its ideal at 2, energies are divided by
// the surface area.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/note.hpp"
#include "core/types/options.hpp"

namespace unwrapd {

/// Distortion of one chart or of all (Sec. 6), after one global scale that makes UV area = 3D area.
struct Distortion {
  double angle = 2;      ///< D_angle
  double area = 2;       ///< D_area
  double stretch = 1;    ///< root mean square of the Jacobians' Frobenius norm / sqrt 2, ideal 1
  Index flipped = 0;     ///< triangles of negative orientation; D is computed on |sigma|
  Index degenerate = 0;  ///< triangles of no height in space to speak of: in none of the means
};

enum class StopReason {
  iterations,      ///< as many plain iterations as were asked for
  direct,          ///< the method is one solve
  collapse_guard,  ///< a step would have shrunk the map to almost nothing
  converged,       ///< the energy fell by less than the tolerance over a window
  max_iterations,  ///< the limit came before convergence
  neighbour,       ///< the map comes from that of another lambda of the list
};

/// What a guarantee took: what was wrong with the solved map, and what putting it right cost.
struct Mending {
  Index flips = 0;                ///< flipped triangles of the solved map that were turned back
  Index overlaps = 0;             ///< overlapping pairs of triangles that were parted
  double energy_rise = 0;         ///< relative; 0 where nothing was mended
  bool virtual_boundary = false;  ///< by the convex virtual boundary (Sec. 4.4)
  Index parts = 1;                ///< the chart was split into so many; 1: it was not
};

struct ChartReport {
  Index surface = 0;  ///< which of the surfaces the chart belongs to
  Index faces = 0;
  Index vertices = 0;
  Index boundaries = 0;    ///< boundary loops of the chart as solved
  double area = 0;         ///< 3D area
  double seam_length = 0;  ///< 3D length of its border to other charts and to itself
  Distortion distortion = {};
  int iterations = 0;
  StopReason stop_reason = StopReason::iterations;
  std::vector<double> energy = {};  ///< energy[0] of the initial map, energy[k] after iteration k
  std::optional<Index> overlaps = {};  ///< overlapping pairs of triangles, where they were counted
  Mending mending = {};
};

/// What the mesh was as it came in, over all surfaces, after the seams were decided.
struct InputReport {
  Index faces = 0;
  Index vertices = 0;
  Index components = 0;
  Index boundaries = 0;
  Index genus = 0;
  bool welded = false;  ///< vertices at equal positions were taken for one (SeamMode)
};

enum class RepairKind {
  degenerate_faces_set_aside,  ///< zero area or a repeated vertex: UVs given at the end
  duplicate_faces_set_aside,   ///< the same three vertices as an earlier face
  non_manifold_edges_split,    ///< more than two faces at an edge, or two of the same direction
  cut_to_disk,                 ///< closed or high-genus components opened along a cut graph
  segmented,                   ///< components taken apart into charts, see max_distortion
  vertices_welded_near,        ///< positions that were welded to others near them, see Welding
  faces_turned,                ///< whose winding was opposite to that of their neighbours
};

/// One point of a lambda curve: all charts together.
struct CurvePoint {
  double lambda = 0;
  double energy = 0;  ///< E of Eq. (5) in the units of lambda, over the surface area
  Distortion distortion = {};
  int iterations = 0;  ///< of the chart that took most
};

struct Repair {
  RepairKind kind = RepairKind::degenerate_faces_set_aside;
  Index surface = 0;
  Index count = 0;  ///< faces, edges, components or positions, as the kind says
};

struct Report {
  InputReport input;
  std::vector<Repair> repairs;
  std::vector<Note> notes;  ///< what the user should know, e.g. an option without effect
  std::vector<ChartReport> charts;
  Distortion distortion = {};                ///< over all charts, area-weighted
  double area = 0;                           ///< 3D area of all charts
  double seam_length = 0;                    ///< 3D length of edges whose UVs differ on both sides
  double seam_ratio = 0;                     ///< seam_length ÷ square root of area
  std::optional<Index> overlaps = {};        ///< of all charts, where they were counted in each
  double fill = 0;                           ///< UV area covered by islands ÷ area of the pages
  Index pages = 1;                           ///< that the islands take, see Packing
  PageSize page = {};                        ///< of each page
  double texel_density = 0;                  ///< texels per unit of length
  Guarantee guarantee = Guarantee::none;     ///< what holds of the UVs that are written
  std::vector<CurvePoint> curve = {};        ///< one for each lambda of a curve, in its order
  std::vector<std::string> page_names = {};  ///< what lies on each page, see PageGroup
};

/// What a job makes of its surfaces.
struct Unwrapped {
  std::vector<UnwrappedSurface> surfaces;  ///< one for each input surface, in order
  Report report;
};

}  // namespace unwrapd
