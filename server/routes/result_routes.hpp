#pragma once
// The answers that a finished job has: the asset and the report.

#include "server/http/http.hpp"
#include "server/results/result_store.hpp"
#include "server/store/blob_store.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server {

/// Whether the sender of a GET has what this ETag names, and asks only for something else.
bool has_copy(const Request& request, const std::string& etag);

/// Throws unless the job has succeeded and its files are still kept: job_unfinished,
/// result_expired, or the job's own problem.
void require_result(const JobRecord& job);

/// A stored file, with ETag, If-None-Match and Range.
Response stored_response(const StoredResult& stored, std::string_view type, const Request& request);

/// The asset by one of the job's maps, in the format that Accept chooses, with ETag, If-None-Match
/// and Range.
Response get_result(ResultStore& results, const JobRecord& job, std::size_t map,
                    const Request& request);

/// A file of the job as it is.
Response get_file(const BlobStore& blobs, const JobRecord& job, std::string_view file,
                  std::string_view type);

}  // namespace unwrapd::server
