#pragma once
// The results of jobs as files, in the job's own format and, made when somebody asks, in others.

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "server/blob_store.hpp"
#include "server/file_counts.hpp"
#include "server/files.hpp"
#include "server/job_record.hpp"

namespace unwrapd::server {

/// "glb", "gltf" or "obj".
std::string_view format_name(asset::Format format);

/// Stores a result of a job's first map.
void write_result(BlobStore& blobs, std::string_view job, std::string_view format,
                  std::string_view bytes);

struct StoredResult {
  std::shared_ptr<const File> file;  ///< stays readable when the job is removed meanwhile
  std::string sha256;                ///< becomes the ETag
};

/// Thread-safe.
class ResultStore {
 public:
  ResultStore(BlobStore& blobs, const api::Limits& limits) : blobs_(blobs), limits_(limits) {}

  /// The result of a succeeded job by one of its maps (see map_choice.hpp), in a format (glb, gltf,
  /// obj, json); one that is missing or damaged is made from the job's input and map. Throws what
  /// asset::write() throws when the asset cannot be had in it, storage_corrupt when those are
  /// damaged too.
  StoredResult open(const JobRecord& job, std::size_t map, std::string_view format);
  [[nodiscard]] const FileCounts& counts() const { return counts_; }

 private:
  /// What lies in the store and is whole.
  [[nodiscard]] std::optional<StoredResult> find(const JobRecord& job,
                                                 const std::string& file) const;
  std::string make(const JobRecord& job, std::size_t map, std::string_view format) const;

  BlobStore& blobs_;
  const api::Limits& limits_;
  FileCounts counts_;
  std::mutex making_;  // one at a time: decoding is worth a worker's time and memory
};

}  // namespace unwrapd::server
