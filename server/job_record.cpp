#include "server/job_record.hpp"

#include "server/clock.hpp"

namespace unwrapd::server {

api::Job to_job(const JobRecord& record) {
  return {.id = record.id,
          .state = record.state,
          .created = rfc3339(record.created_ms),
          .attempt = record.attempt,
          .options = record.options,
          .progress = {},
          .problem = record.problem};
}

}  // namespace unwrapd::server
