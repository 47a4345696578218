#include "server/store/job_record.hpp"

#include "server/base/clock.hpp"
#include "server/store/blob_store.hpp"

namespace unwrapd::server::store {

api::Job to_job(const JobRecord& record) {
  return {.id = record.id,
          .state = record.state,
          .created = rfc3339(record.created_ms),
          .attempt = record.attempt,
          .options = record.options,
          .progress = {},
          .problem = record.problem};
}

Digests digests_of(const JobInput& input) {
  Digests digests;
  const auto add = [&](std::string_view file, const std::string& sha256) {
    if (!sha256.empty()) digests.emplace(file, sha256);
  };
  add(kDocumentFile, input.sha256);
  for (const StoredBuffer& buffer : input.buffers) add(buffer.file, buffer.sha256);
  return digests;
}

}  // namespace unwrapd::server::store
