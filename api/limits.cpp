#include "api/limits.hpp"

namespace unwrapd::api {

Json to_json(const Limits& limits) {
  return {{"max_body_bytes", limits.max_body_bytes},
          {"max_vertices", limits.max_vertices},
          {"max_faces", limits.max_faces},
          {"max_sync_faces", limits.max_sync_faces},
          {"max_iterations", limits.max_iterations},
          {"max_constraints", limits.max_constraints},
          {"max_job_seconds", limits.max_job_seconds},
          {"max_wait_seconds", limits.max_wait_seconds},
          {"max_queue", limits.max_queue},
          {"max_streams", limits.max_streams}};
}

}  // namespace unwrapd::api
