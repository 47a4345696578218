#pragma once
// The pictures of a job, drawn on request from its stored files.

#include <string>

#include "server/blobs/blob_store.hpp"
#include "server/results/files_on_request.hpp"
#include "server/results/renderer.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::results {

/// Thread-safe.
class PictureStore {
 public:
  PictureStore(blobs::BlobStore& blobs, Renderer& renderer)
      : renderer_(renderer), files_(blobs, renderer) {}

  /// The picture of one of the maps of a succeeded job (lambda_selection.hpp). Only usual looks in
  /// sizes that are a power of two are stored with the job, so that requests for all others do not
  /// fill the disk.
  /// A damaged picture is drawn again. Throws what Renderer::render() throws.
  StoredResult open(const store::JobRecord& job, std::size_t map, const work::Picture& picture,
                    const http::HasLeft& has_left = {});
  [[nodiscard]] const FileCounts& counts() const { return files_.counts(); }

 private:
  Renderer& renderer_;
  FilesOnRequest files_;
};

}  // namespace unwrapd::server::results
