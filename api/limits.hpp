#pragma once
// The limits of one server. Every limit is a flag of unwrapd and a member of GET /v1/limits.

#include <cstdint>

#include "api/json.hpp"

namespace unwrapd::api {

struct Limits {
  std::int64_t max_body_bytes = std::int64_t{256} * 1024 * 1024;  ///< of one request
  std::int64_t max_vertices = 10'000'000;
  std::int64_t max_faces = 20'000'000;
  std::int64_t max_sync_faces = 50'000;  ///< POST /v1/unwrap; larger meshes go to /v1/jobs
  int max_iterations = 10'000;           ///< of the options stop.iterations and stop.max_iterations
  int max_constraints = 100'000;         ///< entries of the option constraints
  int max_job_seconds = 600;             ///< of work, without the time in the queue
  int max_wait_seconds = 60;             ///< the longest accepted Prefer: wait
  int max_queue = 256;                   ///< jobs waiting for a worker
  int max_streams = 256;                 ///< event streams open at once
};

Json to_json(const Limits& limits);

}  // namespace unwrapd::api
