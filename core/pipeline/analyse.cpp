#include "core/pipeline/analyse.hpp"

#include <algorithm>
#include <string>

#include "core/base/error.hpp"
#include "core/charts/repair_surfaces.hpp"
#include "core/measure/rest_triangle.hpp"

namespace unwrapd::pipeline {

namespace {

void require_meshes(std::span<const SeamPath> paths, std::size_t meshes,
                    const std::string& option) {
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (paths[k].surface < 0 || static_cast<std::size_t>(paths[k].surface) >= meshes)
      throw Error(ErrorCode::invalid_option,
                  option + ": there is no mesh " + std::to_string(paths[k].surface) +
                      "; name one of the asset's " + std::to_string(meshes) + ", counted from 0",
                  "/" + option + "/" + std::to_string(k) + "/mesh");
}

}  // namespace

std::vector<charts::Charts> components(std::span<const Surface> surfaces, charts::SeamRules rules) {
  const auto is_empty = [](const Surface& surface) { return surface.mesh.faces.empty(); };
  if (std::all_of(surfaces.begin(), surfaces.end(), is_empty))
    throw Error(ErrorCode::no_triangles, "the asset has no triangles; there is nothing to unwrap");
  require_meshes(rules.paths, surfaces.size(), "seam_edges");
  require_meshes(rules.kept, surfaces.size(), "keep_edges");
  std::vector<charts::Charts> parts;
  parts.reserve(surfaces.size());
  for (const Surface& surface : surfaces) {
    parts.push_back(charts::components_of(surface, rules));
    ++rules.surface;
  }
  return parts;
}

InputAnalysis analysis_of(std::span<const charts::Charts> parts) {
  InputAnalysis analysis;
  InputReport& input = analysis.input;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    input.faces += parts[s].input.faces;
    input.vertices += parts[s].input.vertices;
    input.components += parts[s].input.components;
    input.boundaries += parts[s].input.boundaries;
    input.genus += parts[s].input.genus;
    input.welded = input.welded || parts[s].input.welded;
    for (Repair repair : parts[s].repairs) {
      repair.surface = static_cast<Index>(s);
      analysis.repairs.push_back(repair);
    }
  }
  return analysis;
}

std::size_t job_bytes(std::span<const Surface> surfaces) {
  std::size_t faces = 0;
  for (const Surface& surface : surfaces) faces += surface.mesh.faces.size();
  return kJobBytesPerFace * faces;
}

void require_area(std::span<const charts::Charts> parts) {
  constexpr double kLeastArea = 1e-150;  // whose square double precision holds
  double area = 0;
  bool is_tiny = false;
  for (const charts::Charts& part : parts)
    for (const charts::Chart& chart : part.charts) {
      const double own = measure::surface_area(chart.mesh);
      area += own;
      is_tiny = is_tiny || own < kLeastArea;
    }
  if (area == 0)
    throw Error(ErrorCode::zero_area,
                "every triangle has zero area at the precision of its coordinates; move a mesh "
                "that lies far away to the origin");
  if (is_tiny)
    throw Error(ErrorCode::zero_area,
                "a component has less area than can be computed with; scale it to ordinary units "
                "and try again");
}

InputAnalysis analyse(std::span<const Surface> surfaces, const std::stop_token& stop) {
  const charts::RepairedSurfaces repaired = charts::repair_surfaces(surfaces, {}, stop);
  const std::vector<charts::Charts> parts = components(repaired.surfaces, {.stop = stop});
  require_area(parts);
  InputAnalysis analysis = analysis_of(parts);
  analysis.repairs.insert(analysis.repairs.begin(), repaired.repairs.begin(),
                          repaired.repairs.end());
  return analysis;
}

}  // namespace unwrapd::pipeline
