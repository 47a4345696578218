#pragma once
// The results of jobs as files: in the job's own format, and in others made on request.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/asset/asset.hpp"
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
/// A file that was made after the end of its job, kept where that takes nothing from others and no
/// other job has taken its id meanwhile.
StoredResult keep(blobs::BlobStore& blobs, const store::JobRecord& job, const std::string& file,
                  std::string_view bytes);
/// One that is handed out once.
StoredResult lend(const blobs::BlobStore& blobs, std::string_view bytes);

/// Who hands out results that are in a bucket.
enum class ResultsFrom { node, bucket };

/// Thread-safe.
class ResultStore {
 public:
  ResultStore(blobs::BlobStore& blobs, Renderer& renderer, ResultsFrom from = ResultsFrom::node)
      : blobs_(blobs), renderer_(renderer), from_(from) {}

  /// The result of a succeeded job by one of its maps (see lambda_selection.hpp), in a format (glb,
  /// gltf, obj, json); one that is missing or damaged is made from the job's input and map. Throws
  /// what Renderer::render() throws.
  StoredResult open(const store::JobRecord& job, std::size_t map, std::string_view format,
                    const http::HasLeft& has_left = {});
  /// The same result, where the bucket hands it out: for a client that asks by this method (GET or
  /// HEAD). Nothing where the bucket has none of this map and format.
  std::optional<blobs::ResultLink> link(const store::JobRecord& job, std::size_t map,
                                        std::string_view format, std::string_view method);
  [[nodiscard]] const FileCounts& counts() const { return counts_; }

 private:
  blobs::BlobStore& blobs_;
  Renderer& renderer_;
  const ResultsFrom from_;
  FileCounts counts_;
};

}  // namespace unwrapd::server::results
