#include "server/routes/result_routes.hpp"

#include "api/error_table.hpp"
#include "server/http/media_types.hpp"

namespace unwrapd::server {
namespace {

/// Range counts when there is no If-Range, or when that is the tag of what would be sent.
bool range_counts(const Request& request, const std::string& etag) {
  const std::string condition = request.header("If-Range");
  return request.method == "GET" && (condition.empty() || condition == etag);
}

void send_range(const Request& request, FileBody& body, Response& response) {
  const std::int64_t size = body.length;
  const std::optional<ByteRange> range = single_range(request.header("Range"), size);
  if (!range) return;
  body.offset = range->offset;
  body.length = range->length;
  response.status = 206;
  response.headers.emplace_back("Content-Range",
                                "bytes " + std::to_string(range->offset) + "-" +
                                    std::to_string(range->offset + range->length - 1) + "/" +
                                    std::to_string(size));
}

}  // namespace

bool has_copy(const Request& request, const std::string& etag) {
  if (request.method == "POST") return false;  // an answer to a call, not a copy of a resource
  const std::string if_none_match = request.header("If-None-Match");
  return if_none_match == "*" || if_none_match.find(etag) != std::string::npos;
}

void require_result(const JobRecord& job) {
  if (!api::is_final(job.state)) {
    throw Error(ErrorCode::job_unfinished,
                "The job has not ended; ask again when its state is succeeded.");
  }
  if (job.state != api::JobState::succeeded) throw Error(api::error_from_problem(job.problem));
  if (job.expired) {
    throw Error(ErrorCode::result_expired,
                "The result has expired; send the job again, under a new name if it had one.");
  }
}

Response stored_response(const StoredResult& stored, std::string_view type,
                         const Request& request) {
  const std::string etag = "\"" + stored.sha256 + "\"";
  Response response;
  response.headers = {{"ETag", etag}, {"Accept-Ranges", "bytes"}};
  if (has_copy(request, etag)) {
    response.status = 304;
    return response;
  }
  response.content_type = type;
  FileBody body{.file = stored.file, .offset = 0, .length = stored.file->size()};
  if (range_counts(request, etag)) send_range(request, body, response);
  response.body = std::move(body);
  return response;
}

Response get_result(ResultStore& results, const JobRecord& job, std::size_t map,
                    const Request& request) {
  require_result(job);
  const std::string format = choose_format(request.header("Accept"), job.result_format);
  Response response = stored_response(results.open(job, map, format, request.has_left),
                                      media_type(format), request);
  response.headers.emplace_back("Vary", "Accept");
  return response;
}

Response get_file(const BlobStore& blobs, const JobRecord& job, std::string_view file,
                  std::string_view type) {
  require_result(job);
  const std::shared_ptr<const File> opened = blobs.open(job.id, file);
  Response response;
  response.content_type = type;
  response.body = FileBody{.file = opened, .offset = 0, .length = opened->size()};
  return response;
}

}  // namespace unwrapd::server
