#include "core/pipeline/as_mapped.hpp"

namespace unwrapd::pipeline {

charts::RepairedSurfaces as_mapped(std::span<const Surface> given, const UnwrapOptions& options,
                                   std::vector<UnwrappedSurface>& unwrapped,
                                   const std::stop_token& stop) {
  if (options.keeps_uvs()) return {given, {}, {}, {}};
  charts::RepairedSurfaces repaired = charts::repair_surfaces(given, options.welding, stop);
  charts::exchange_winding(repaired, unwrapped);
  return repaired;
}

}  // namespace unwrapd::pipeline
