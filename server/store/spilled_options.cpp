#include "server/store/spilled_options.hpp"

#include "server/store/job_rows.hpp"

namespace unwrapd::server::store {

void shorten_options(JobRecord& job, const UploadFolder& folder) {
  const std::string text = text_of(job.options);
  if (text.size() <= kLongOptions) return;
  const auto bytes = static_cast<std::int64_t>(text.size());
  folder.room.take(bytes);
  write_file(folder.path / kOptionsFile, text);
  job.stored_bytes += bytes;
  job.options = without_long_members(job.options);
}

api::Json without_long_members(const api::Json& options) {
  if (text_of(options).size() <= kLongOptions) return options;
  api::Json shown = api::Json::object();
  for (const auto& [name, value] : options.items())
    if (text_of(value).size() <= kLongMember) shown[name] = value;
  return shown;
}

api::Json whole_options(const BlobStore& blobs, const JobRecord& job) {
  if (!blobs.has(job.id, kOptionsFile)) return job.options;
  return api::Json::parse(blobs.read(job.id, kOptionsFile));
}

}  // namespace unwrapd::server::store
