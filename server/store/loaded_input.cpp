#include "server/store/loaded_input.hpp"

#include "server/store/spilled_options.hpp"

namespace unwrapd::server::store {

LoadedInput::LoadedInput(const BlobStore& blobs, const JobRecord& job)
    : record_(job), document_(blobs.read(job.id, kDocumentFile)) {
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

}  // namespace unwrapd::server::store
