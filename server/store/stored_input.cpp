#include "server/store/stored_input.hpp"

#include "server/store/job_rows.hpp"

namespace unwrapd::server::store {

LoadedInput::LoadedInput(const blobs::BlobStore& blobs, const JobRecord& job)
    : record_(job), document_(blobs.read(job.id, blobs::kDocumentFile)) {
  record_.options = whole_options(blobs, job);
  buffers_.reserve(job.input.buffers.size());
  for (const StoredBuffer& buffer : job.input.buffers)
    buffers_.emplace_back(buffer.uri, blobs.read(job.id, buffer.file));
}

asset::Input LoadedInput::input() const {
  asset::Input input{.document = document_, .buffers = {}};
  for (const auto& [uri, bytes] : buffers_) input.buffers[uri] = bytes;
  return input;
}

void shorten_options(JobRecord& job, const UploadFolder& folder) {
  const std::string text = api::to_text(job.options);
  if (text.size() <= kLongOptions) return;
  const auto bytes = static_cast<std::int64_t>(text.size());
  folder.room.take(bytes);
  write_file(folder.path / blobs::kOptionsFile, text);
  job.stored_bytes += bytes;
  job.options = without_long_members(job.options);
}

api::Json without_long_members(const api::Json& options) {
  if (api::to_text(options).size() <= kLongOptions) return options;
  api::Json shown = api::Json::object();
  for (const auto& [name, value] : options.items())
    if (api::to_text(value).size() <= kLongMember) shown[name] = value;
  return shown;
}

api::Json whole_options(const blobs::BlobStore& blobs, const JobRecord& job) {
  if (!blobs.has(job.id, blobs::kOptionsFile)) return job.options;
  return api::Json::parse(blobs.read(job.id, blobs::kOptionsFile));
}

}  // namespace unwrapd::server::store
