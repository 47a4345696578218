#pragma once
// The first step on every surface: vertices that were written with rounding are welded, and winding
// is made consistent. All later steps see the repaired surfaces.

#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::charts {

/// Surfaces whose vertices and faces have the numbers of the input. A vertex that was welded to
/// another has its position. A face that was turned has its second and third corner exchanged.
struct RepairedSurfaces {
  std::span<const Surface> surfaces;      ///< the input, or `changed`
  std::vector<Surface> changed;           ///< empty if no surface needed a repair
  std::vector<std::vector<char>> turned;  ///< turned[s][t] of a face; turned[s] is empty for none
  std::vector<Repair> repairs;
};

/// Throws Error{cancelled}. The result refers to the input.
RepairedSurfaces repair_surfaces(std::span<const Surface> surfaces, const Welding& welding,
                                 const std::stop_token& stop = {});

/// Exchanges the second and third corner of the faces that were turned: from the winding of the
/// repaired surfaces to that of the file, or back.
void exchange_winding(const RepairedSurfaces& repaired, std::vector<UnwrappedSurface>& unwrapped);

}  // namespace unwrapd::charts
