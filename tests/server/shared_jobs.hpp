#pragma once
// Jobs that share a cache, and what they answer.

#include <string>
#include <vector>

#include "api/report.hpp"
#include "core/unwrap.hpp"
#include "server/work/solver_cache.hpp"
#include "server/work/thread_executor.hpp"
#include "server/work/uv_file.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::server {

inline constexpr work::MemoryLimits kRoomForAll{.cache_bytes = std::int64_t{1} << 32,
                                                .job_bytes = std::int64_t{1} << 40};

using Surfaces = std::vector<Surface>;

/// A job's whole answer as bytes: UVs, and all that is told of them. cache: null where the job is
/// alone.
inline std::string answer(const Surfaces& surfaces, const UnwrapOptions& options,
                          work::SolverCache* cache, int threads = 1,
                          const Progress& progress = {}) {
  work::ThreadExecutor executor(threads, cache);
  const Unwrapped unwrapped = unwrap(surfaces, options, progress, executor);
  return work::encode_uvs(unwrapped.surfaces) + api::to_json(unwrapped.report, {}).dump();
}

inline TriMesh bent(TriMesh mesh, double by) {
  for (Vec3& p : mesh.positions) p.z() += by * p.x() * p.x();
  return mesh;
}

}  // namespace unwrapd::server
