#pragma once
// The results of jobs as files: in the job's own format, and in others made on request.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/asset/asset.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/results/files_on_request.hpp"
#include "server/results/renderer.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::results {

/// Who hands out results that are in a bucket.
enum class ResultsFrom { node, bucket };

/// Thread-safe.
class ResultStore {
 public:
  ResultStore(blobs::BlobStore& blobs, Renderer& renderer, ResultsFrom from = ResultsFrom::node)
      : blobs_(blobs), renderer_(renderer), files_(blobs, renderer), from_(from) {}

  /// The result of a succeeded job by one of its maps (see lambda_selection.hpp), in a format (glb,
  /// gltf, obj, json); one that is missing or damaged is made from the job's input and map. Throws
  /// what Renderer::render() throws.
  StoredResult open(const store::JobRecord& job, std::size_t map, std::string_view format,
                    const http::HasLeft& has_left = {});
  /// The same result, where the bucket hands it out: for a client that asks by this method (GET or
  /// HEAD). Nothing where the bucket has none of this map and format.
  std::optional<blobs::ResultLink> link(const store::JobRecord& job, std::size_t map,
                                        std::string_view format, std::string_view method);
  [[nodiscard]] const FileCounts& counts() const { return files_.counts(); }

 private:
  blobs::BlobStore& blobs_;
  Renderer& renderer_;
  FilesOnRequest files_;
  const ResultsFrom from_;
};

}  // namespace unwrapd::server::results
