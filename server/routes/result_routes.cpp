#include "server/routes/result_routes.hpp"

#include "api/error_table.hpp"
#include "server/http/gzip.hpp"
#include "server/http/media_types.hpp"

namespace unwrapd::server::routes {
namespace {

/// Range is used without If-Range, or if that is the tag of the current file.
bool range_counts(const http::Request& request, const std::string& etag) {
  const std::string condition = request.header("If-Range");
  return request.method == "GET" && (condition.empty() || condition == etag);
}

void send_range(const http::Request& request, http::FileBody& body, http::Response& response) {
  const std::int64_t size = body.length;
  const std::optional<http::ByteRange> range = http::single_range(request.header("Range"), size);
  if (!range) return;
  body.offset = range->offset;
  body.length = range->length;
  response.status = 206;
  response.headers.emplace_back("Content-Range",
                                "bytes " + std::to_string(range->offset) + "-" +
                                    std::to_string(range->offset + range->length - 1) + "/" +
                                    std::to_string(size));
}

http::Response result_in(const std::string& format, results::ResultStore& results,
                         const store::JobRecord& job, std::size_t map,
                         const http::Request& request) {
  return stored_response(results.open(job, map, format, request.has_left), http::media_type(format),
                         request);
}

http::Response linked_response(const blobs::ResultLink& linked, std::string_view type,
                               const http::Request& request) {
  const std::string etag = "\"" + linked.sha256 + "\"";
  if (has_copy(request, etag)) return not_modified(request, etag, type);
  http::Response response;
  response.status = 307;
  response.headers = {{"ETag", etag}, {"Location", linked.url}, {"Cache-Control", "no-store"}};
  return response;
}

}  // namespace

bool has_copy(const http::Request& request, const std::string& etag) {
  if (request.method == "POST") return false;  // an answer to a call, not a copy of a resource
  const std::string if_none_match = request.header("If-None-Match");
  return if_none_match == "*" || if_none_match.find(etag) != std::string::npos ||
         if_none_match.find(http::gzip_etag(etag)) != std::string::npos;
}

http::Response not_modified(const http::Request& request, const std::string& etag,
                            std::string_view type) {
  const std::string as_gzip = http::gzip_etag(etag);
  const bool is_gzip = request.header("If-None-Match").find(as_gzip) != std::string::npos;
  http::Response response;
  response.status = 304;
  response.content_type = type;
  response.headers = {{"ETag", is_gzip ? as_gzip : etag}};
  return response;
}

void require_result(const store::JobRecord& job) {
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

http::Response stored_response(const results::StoredResult& stored, std::string_view type,
                               const http::Request& request) {
  const std::string etag = "\"" + stored.sha256 + "\"";
  if (has_copy(request, etag)) return not_modified(request, etag, type);
  http::Response response;
  response.headers = {{"ETag", etag}, {"Accept-Ranges", "bytes"}};
  response.content_type = type;
  http::FileBody body{.file = stored.file, .offset = 0, .length = stored.file->size()};
  if (range_counts(request, etag)) send_range(request, body, response);
  response.body = std::move(body);
  return response;
}

http::Response get_result(results::ResultStore& results, const store::JobRecord& job,
                          std::size_t map, const http::Request& request) {
  require_result(job);
  const std::string format = http::choose_format(request.header("Accept"), job.result_format);
  http::Response response = result_in(format, results, job, map, request);
  response.headers.emplace_back("Vary", "Accept");
  return response;
}

http::Response get_result_or_link(results::ResultStore& results, const store::JobRecord& job,
                                  std::size_t map, const http::Request& request) {
  require_result(job);
  const std::string format = http::choose_format(request.header("Accept"), job.result_format);
  // The bucket does not know our tags.
  const bool is_conditional = request.headers.contains("If-Match");
  const auto linked =
      is_conditional ? std::nullopt : results.link(job, map, format, request.method);
  if (!linked) return get_result(results, job, map, request);
  http::Response response = linked_response(*linked, http::media_type(format), request);
  response.headers.emplace_back("Vary", "Accept");
  return response;
}

http::Response get_json_result(results::ResultStore& results, const store::JobRecord& job,
                               std::size_t map, const http::Request& request) {
  require_result(job);
  return result_in("json", results, job, map, request);
}

http::Response get_file(const blobs::BlobStore& blobs, const store::JobRecord& job,
                        std::string_view file, std::string_view type) {
  require_result(job);
  const std::shared_ptr<const File> opened = blobs.open(job.id, file);
  http::Response response;
  response.content_type = type;
  response.body = http::FileBody{.file = opened, .offset = 0, .length = opened->size()};
  return response;
}

}  // namespace unwrapd::server::routes
