#pragma once
// The results of jobs as files, in the job's own format and, made when somebody asks, in others.

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "api/limits.hpp"
#include "core/asset/asset.hpp"
#include "server/blob_store.hpp"
#include "server/files.hpp"
#include "server/job_record.hpp"

namespace unwrapd::server {

/// "glb", "gltf" or "obj".
std::string_view format_name(asset::Format format);

/// Stores a result of a job's first map and, beside it, the SHA-256 that becomes its ETag.
void write_result(BlobStore& blobs, std::string_view job, std::string_view format,
                  std::string_view bytes);

struct StoredResult {
  std::shared_ptr<const File> file;  ///< stays readable when the job is removed meanwhile
  std::string sha256;
};

/// Thread-safe.
class ResultStore {
 public:
  ResultStore(BlobStore& blobs, const api::Limits& limits) : blobs_(blobs), limits_(limits) {}

  /// The result of a succeeded job by one of its maps (see map_choice.hpp), in a format (glb, gltf,
  /// obj, json). Throws what asset::write() throws when the asset cannot be had in it.
  StoredResult open(const JobRecord& job, std::size_t map, std::string_view format);

 private:
  std::string make(const JobRecord& job, std::size_t map, std::string_view format) const;

  BlobStore& blobs_;
  const api::Limits& limits_;
  std::mutex making_;  // one at a time: decoding is worth a worker's time and memory
};

}  // namespace unwrapd::server
