#pragma once
// The answers that a finished job has: the asset and the report.

#include "server/blobs/blob_store.hpp"
#include "server/http/http.hpp"
#include "server/results/result_store.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::routes {

/// Whether the sender of a GET has what this ETag names, and asks only for something else.
bool has_copy(const http::Request& request, const std::string& etag);

/// The answer to it, under the ETag of the copy that it has, which may be one as gzip. type: of
/// what was asked for.
http::Response not_modified(const http::Request& request, const std::string& etag,
                            std::string_view type);

/// Throws unless the job has succeeded and its files are still kept: job_unfinished,
/// result_expired, or the job's own problem.
void require_result(const store::JobRecord& job);

/// A stored file, with ETag, If-None-Match and Range.
http::Response stored_response(const results::StoredResult& stored, std::string_view type,
                               const http::Request& request);

/// The asset by one of the job's maps, in the format that Accept chooses, with ETag, If-None-Match
/// and Range.
http::Response get_result(results::ResultStore& results, const store::JobRecord& job,
                          std::size_t map, const http::Request& request);

/// The same, or a redirect to the bucket that hands it out. For GET and HEAD.
http::Response get_result_or_link(results::ResultStore& results, const store::JobRecord& job,
                                  std::size_t map, const http::Request& request);

/// The report and the meshes as JSON, whatever Accept says, like get_result().
http::Response get_json_result(results::ResultStore& results, const store::JobRecord& job,
                               std::size_t map, const http::Request& request);

/// A file of the job as it is.
http::Response get_file(const blobs::BlobStore& blobs, const store::JobRecord& job,
                        std::string_view file, std::string_view type);

}  // namespace unwrapd::server::routes
