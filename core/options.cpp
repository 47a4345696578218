#include "core/options.hpp"

#include <cmath>
#include <string>

#include "core/error.hpp"

namespace unwrapd {
namespace {

void require(bool holds, const std::string& what, const std::string& pointer) {
  if (!holds) throw Error(ErrorCode::invalid_option, what, pointer);
}

}  // namespace

void validate(const UnwrapOptions& options, int max_iterations) {
  require(options.lambda >= 0 && !std::isnan(options.lambda),
          "lambda must be a number of at least 0", "/lambda");
  require(options.iterations >= 1 && options.iterations <= max_iterations,
          "iterations must lie between 1 and " + std::to_string(max_iterations), "/iterations");
  require(options.resolution >= kMinResolution && options.resolution <= kMaxResolution,
          "resolution must lie between " + std::to_string(kMinResolution) + " and " +
              std::to_string(kMaxResolution) + " texels",
          "/resolution");
  require(options.padding >= 0 && 4 * options.padding <= options.resolution,
          "padding must lie between 0 and a quarter of resolution", "/padding");
}

}  // namespace unwrapd
