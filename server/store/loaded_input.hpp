#pragma once
// A stored job's input, read again for those who work on it.

#include <string>
#include <utility>
#include <vector>

#include "core/asset/asset.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::store {

/// A job's input in memory, and its record with all its options, checked against their digests; the
/// views of input() live as long as this. Throws Error{storage_corrupt}.
class LoadedInput {
 public:
  LoadedInput(const BlobStore& blobs, const JobRecord& job);
  [[nodiscard]] asset::Input input() const;
  [[nodiscard]] const JobRecord& record() const { return record_; }

 private:
  JobRecord record_;
  std::string document_;
  std::vector<std::pair<std::string, std::string>> buffers_;  // URI, bytes
};

}  // namespace unwrapd::server::store
