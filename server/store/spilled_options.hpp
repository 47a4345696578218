#pragma once
// Options may be megabytes (constraints, seam edges). Those are a file of the job, counted and kept
// like its mesh; the row in the store, the events and the lists have them without the long members.

#include "api/json.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/job_record.hpp"
#include "server/store/upload_meter.hpp"

namespace unwrapd::server::store {

/// Options longer than this are a file, and members of them longer than the second are left out.
inline constexpr std::size_t kLongOptions = std::size_t{4} * 1024;
inline constexpr std::size_t kLongMember = 1024;

/// Puts the options of a job that is about to be stored into its upload's folder, when they are
/// long. Throws what UploadMeter throws, and storage_failed.
void shorten_options(JobRecord& job, const UploadFolder& folder);

/// Options as they are repeated: the same when they are short, or have been through this.
api::Json without_long_members(const api::Json& options);

/// All options of a stored job. Throws Error{storage_corrupt}.
api::Json whole_options(const BlobStore& blobs, const JobRecord& job);

}  // namespace unwrapd::server::store
