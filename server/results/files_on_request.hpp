#pragma once
// Files that are made from the stored files of a job when somebody asks for them, and kept with the
// job.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/base/files.hpp"
#include "server/base/metrics.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/results/renderer.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::results {

struct StoredResult {
  std::shared_ptr<const File> file;  ///< stays readable when the job is removed meanwhile
  std::string sha256;                ///< becomes the ETag
};

/// A file of a job that exists and matches its digest.
std::optional<StoredResult> find_whole(const blobs::BlobStore& blobs, const std::string& job,
                                       const std::string& file);

/// Thread-safe.
class FilesOnRequest {
 public:
  FilesOnRequest(blobs::BlobStore& blobs, Renderer& renderer)
      : blobs_(blobs), renderer_(renderer) {}

  /// The file as it is kept; else make() returns its bytes, once Renderer::enter() has let the
  /// request in. A damaged file is made again. Throws what enter() and make() throw.
  StoredResult open(const store::JobRecord& job, const WantedFile& wanted,
                    const std::function<std::string()>& make);
  [[nodiscard]] const FileCounts& counts() const { return counts_; }

 private:
  blobs::BlobStore& blobs_;
  Renderer& renderer_;
  FileCounts counts_;
};

}  // namespace unwrapd::server::results
