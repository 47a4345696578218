#include "server/work/worker_answer.hpp"

#include "api/error_table.hpp"
#include "api/json.hpp"
#include "core/base/byte_pack.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::work {
namespace {

constexpr std::size_t kMaxErrorText = 65536;
constexpr std::size_t kMaxReason = 1000;

/// The text of an error, which may quote a mesh: invalid UTF-8 is replaced, and a long text is cut.
std::string readable(std::string_view text) {
  return api::Json::parse(api::to_text(text.substr(0, kMaxErrorText))).get<std::string>();
}

}  // namespace

bool is_of_work(ErrorCode code) {
  using enum ErrorCode;
  switch (code) {  // each code is here, so that a new one is not forgotten
    case invalid_option:
    case body_too_large:  // a GLB beyond 4 GiB
    case unknown_format:
    case malformed_glb:
    case malformed_json:
    case malformed_gltf:
    case malformed_obj:
    case malformed_mesh:
    case malformed_draco:
    case malformed_meshopt:
    case malformed_image:
    case missing_buffer:
    case external_uri:
    case unsupported_extension:
    case unsupported_image:
    case too_many_vertices:
    case too_many_faces:
    case too_much_memory:
    case no_triangles:
    case zero_area:
    case non_finite_position:
    case not_orientable:
    case invalid_constraint:
    case no_texture_coordinates:
    case does_not_fit:
    case solver_failed:
    case guarantee_failed:
    case memory_limit:
    case cancelled:
    case storage_failed:  // a stored map that is none
    case internal:
      return true;
    case malformed_request:
    case not_found:
    case method_not_allowed:
    case not_acceptable:
    case request_timeout:
    case job_unfinished:
    case result_expired:
    case length_required:
    case unsupported_media_type:
    case headers_too_large:
    case queue_full:
    case draining:
    case too_many_streams:
    case unauthorized:
    case forbidden:
    case invalid_link:
    case idempotency_conflict:
    case rate_limited:
    case too_many_jobs:
    case quota_exceeded:
    case webhook_refused:
    case source_refused:
    case source_failed:
    case mesh_not_found:
    case digest_mismatch:
    case time_limit:
    case poison:
    case storage_full:
    case storage_corrupt:
      return false;
  }
  return false;
}

ToldFailure failure_told(const Frame& frame) {
  ByteUnpacker from(frame.bytes);
  const std::string message = readable(from.next_text());
  const std::string where = readable(from.next_text());
  const std::string reason = readable(from.next_text().substr(0, kMaxReason));
  const std::optional<ErrorCode> code = api::code_named(frame.name);
  if (!code || !is_of_work(*code))
    throw Error(ErrorCode::internal, "Work on a mesh cannot end so.");
  return {.error = Error(*code, message, where), .reason = reason};
}

bool is_result_format(std::string_view name) {
  return name == "glb" || name == "gltf" || name == "obj";
}

AnswerFiles::AnswerFiles(std::size_t maps) : left_{std::string(blobs::kTotalsFile)} {
  for (std::size_t map = 0; map < maps; ++map) {
    left_.insert(map_file(blobs::kUvFile, map));
    left_.insert(map_file(blobs::kReportFile, map));
  }
}

bool AnswerFiles::take(std::string_view name) {
  const auto file = left_.find(name);
  if (file == left_.end()) return false;
  left_.erase(file);
  return true;
}

bool AnswerFiles::take_result(std::string_view format) {
  if (has_result_ || !is_result_format(format)) return false;
  return has_result_ = true;
}

}  // namespace unwrapd::server::work
