#include "server/store/job_record.hpp"

#include <algorithm>

#include "server/base/clock.hpp"
#include "server/blobs/blob_store.hpp"

namespace unwrapd::server::store {

api::Job to_job(const JobRecord& record) {
  api::Job job{.id = record.id,
               .name = record.name,
               .state = record.state,
               .created = rfc3339(record.created_ms),
               .attempt = record.attempt,
               .options = record.options,
               .problem = record.problem};
  if (record.finished_ms == 0) return job;
  job.finished = rfc3339(record.finished_ms);
  const std::int64_t passed_ms =  // clocks are set back
      std::max<std::int64_t>(record.finished_ms - record.created_ms, 0);
  job.duration = static_cast<double>(passed_ms) / kMsPerSecond;
  return job;
}

blobs::Digests digests_of(const JobInput& input) {
  blobs::Digests digests;
  const auto add = [&](std::string_view file, const std::string& sha256) {
    if (!sha256.empty()) digests.emplace(file, sha256);
  };
  add(blobs::kDocumentFile, input.sha256);
  for (const StoredBuffer& buffer : input.buffers) add(buffer.file, buffer.sha256);
  return digests;
}

}  // namespace unwrapd::server::store
