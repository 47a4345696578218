#include "api/special_options.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <variant>

#include "api/constraints.hpp"
#include "api/locked_islands.hpp"
#include "api/seam_paths.hpp"

namespace unwrapd::api {

Json get_lambda(const JobOptions& options) {
  const UnwrapOptions& unwrap = options.unwrap;
  return unwrap.lambda_curve.empty() ? Json(unwrap.lambda) : Json(unwrap.lambda_curve);
}

void set_lambda(JobOptions& options, const Json& value) {
  if (value.is_null()) return;
  if (value.is_array()) {
    options.unwrap.lambda_curve = value.get<std::vector<double>>();
  } else {
    options.unwrap.lambda = value.get<double>();
  }
}

Json get_texcoord(const JobOptions& options) {
  if (const int* set = std::get_if<int>(&options.asset.texcoord)) return *set;
  return kTexcoordChoices[static_cast<std::size_t>(
      std::get<TexcoordChoice>(options.asset.texcoord))];
}

void set_texcoord(JobOptions& options, const Json& value) {
  if (value.is_number()) {
    options.asset.texcoord = value.get<int>();
  } else {
    const auto found = std::ranges::find(kTexcoordChoices, value.get_ref<const std::string&>());
    options.asset.texcoord = static_cast<TexcoordChoice>(found - kTexcoordChoices.begin());
  }
}

/// The choices in the order of PageFit, after PageFit::given.
Json get_resolution(const JobOptions& options) {
  const UnwrapOptions& unwrap = options.unwrap;
  if (unwrap.page_fit == PageFit::given) return unwrap.resolution;
  return kPageSizeChoices[static_cast<std::size_t>(unwrap.page_fit) - 1];
}

void set_resolution(JobOptions& options, const Json& value) {
  UnwrapOptions& unwrap = options.unwrap;
  unwrap.page_fit = PageFit::given;
  if (value.is_number()) {
    unwrap.resolution = value.get<int>();
  } else {
    const auto found = std::ranges::find(kPageSizeChoices, value.get_ref<const std::string&>());
    unwrap.page_fit = static_cast<PageFit>(found - kPageSizeChoices.begin() + 1);
  }
}

Json get_weld(const JobOptions& options) {
  return options.unwrap.welding.mode == WeldMode::exact ? "exact" : "auto";
}

void set_weld(JobOptions& options, const Json& value) {
  options.unwrap.welding.mode = value == "exact" ? WeldMode::exact : WeldMode::automatic;
}

Json get_constraints(const JobOptions& options) { return to_json(options.unwrap.constraints); }

void set_constraints(JobOptions& options, const Json& value) {
  options.unwrap.constraints =
      constraints_from_json(value, std::numeric_limits<int>::max(), "/constraints");
}

Json get_seam_edges(const JobOptions& options) { return to_json(options.unwrap.seam_edges); }

void set_seam_edges(JobOptions& options, const Json& value) {
  options.unwrap.seam_edges = seam_paths_from_json(value, "seam_edges");
}

Json get_keep_edges(const JobOptions& options) { return to_json(options.unwrap.keep_edges); }

void set_keep_edges(JobOptions& options, const Json& value) {
  options.unwrap.keep_edges = seam_paths_from_json(value, "keep_edges");
}

Json get_locked_islands(const JobOptions& options) {
  return to_json(options.unwrap.locked_islands);
}

void set_locked_islands(JobOptions& options, const Json& value) {
  options.unwrap.locked_islands = locked_islands_from_json(value, "/locked_islands");
}

}  // namespace unwrapd::api
