#pragma once
// What surfaces are as they come in, and what of them would have to be repaired: how unwrap()
// begins, for who wants to know no more.

#include <cstddef>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/shared_cache.hpp"
#include "core/charts/charts.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/options.hpp"
#include "core/types/report.hpp"

namespace unwrapd::pipeline {

struct InputAnalysis {
  InputReport input;            ///< over all surfaces
  std::vector<Repair> repairs;  ///< of every surface in turn
};

/// The components of every surface. rules holds the seam paths of all surfaces; its `surface` is
/// the number of surfaces.front(). Throws Error: no_triangles, not_orientable, invalid_option,
/// cancelled.
std::vector<charts::Charts> components(std::span<const Surface> surfaces, charts::SeamRules rules);

/// What is known of surfaces by their components. Repairs that taking these apart into charts would
/// need are among them once that is done.
InputAnalysis analysis_of(std::span<const charts::Charts> parts);

/// Memory that a job on these surfaces takes, beside its factors.
std::size_t job_bytes(std::span<const Surface> surfaces);

/// Throws Error: no_triangles, zero_area, not_orientable, cancelled.
InputAnalysis analyse(std::span<const Surface> surfaces, const std::stop_token& stop = {});

/// Throws Error{zero_area} when the charts have no area, or one has less than can be computed with.
void require_area(std::span<const charts::Charts> parts);

}  // namespace unwrapd::pipeline
