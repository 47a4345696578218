#pragma once
// The pictures of a job: drawn when somebody asks, from what the job keeps anyway.

#include <string>

#include "server/results/renderer.hpp"
#include "server/results/result_store.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server {

/// Thread-safe.
class PictureStore {
 public:
  PictureStore(BlobStore& blobs, Renderer& renderer) : blobs_(blobs), renderer_(renderer) {}

  /// The picture of one of a succeeded job's maps (see map_choice.hpp). Those whose size is a power
  /// of two are kept with the job, so that whoever asks for every size fills no disk; a damaged one
  /// is drawn again. Throws what Renderer::render() throws.
  StoredResult open(const JobRecord& job, std::size_t map, const Picture& picture,
                    const HasLeft& has_left = {});
  [[nodiscard]] const FileCounts& counts() const { return counts_; }

 private:
  BlobStore& blobs_;
  Renderer& renderer_;
  FileCounts counts_;
};

}  // namespace unwrapd::server
