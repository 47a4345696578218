#pragma once
// The input of a job in its folder. Options may be megabytes (constraints, seam edges). Long ones
// are a file of the job, counted and kept like its mesh; the row in the store, the events and the
// lists have them without their long members.

#include <string>
#include <utility>
#include <vector>

#include "api/json.hpp"
#include "core/asset/asset.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/store/job_record.hpp"
#include "server/store/upload_meter.hpp"

namespace unwrapd::server::store {

/// Options longer than kLongOptions are a file; the row lacks members longer than kLongMember.
inline constexpr std::size_t kLongOptions = std::size_t{4} * 1024;
inline constexpr std::size_t kLongMember = 1024;

/// Writes the options of a job that is about to be stored into its upload's folder if they are
/// long, and shortens those of the record. Throws what UploadMeter throws, and storage_failed.
void shorten_options(JobRecord& job, const UploadFolder& folder);

/// The options as rows, events and lists have them: short options are unchanged.
api::Json without_long_members(const api::Json& options);

/// All options of a stored job. Throws Error{storage_corrupt}.
api::Json whole_options(const blobs::BlobStore& blobs, const JobRecord& job);

/// A job's input in memory, and its record with all its options, checked against their digests. The
/// views of input() live as long as this. Throws Error{storage_corrupt}.
class LoadedInput {
 public:
  LoadedInput(const blobs::BlobStore& blobs, const JobRecord& job);
  [[nodiscard]] asset::Input input() const;
  [[nodiscard]] const JobRecord& record() const { return record_; }

 private:
  JobRecord record_;
  std::string document_;
  std::vector<std::pair<std::string, std::string>> buffers_;  // URI, bytes
};

}  // namespace unwrapd::server::store
