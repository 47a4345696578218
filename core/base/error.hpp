#pragma once
// The one error type of the project. It is thrown where the cause is known and caught at three
// edges only: the HTTP handler wrapper, the worker loop and the command line's main.
// api/error_table.cpp gives every code its wire name, HTTP status and title.

#include <stdexcept>
#include <string>
#include <utility>

namespace unwrapd {

enum class ErrorCode {
  // the request
  malformed_request,
  invalid_option,
  not_found,
  method_not_allowed,
  not_acceptable,
  request_timeout,
  job_unfinished,
  result_expired,
  length_required,
  body_too_large,
  unsupported_media_type,
  headers_too_large,
  queue_full,
  draining,
  too_many_streams,
  unauthorized,
  forbidden,
  invalid_link,
  idempotency_conflict,
  rate_limited,
  too_many_jobs,
  quota_exceeded,
  webhook_refused,
  mesh_not_found,
  digest_mismatch,
  // the asset's bytes
  unknown_format,
  malformed_glb,
  malformed_json,
  malformed_gltf,
  malformed_obj,
  malformed_mesh,  ///< an STL, a PLY, an OFF or a zip archive
  malformed_draco,
  malformed_meshopt,
  malformed_image,
  missing_buffer,
  external_uri,
  unsupported_extension,
  unsupported_image,
  // the mesh
  too_many_vertices,
  too_many_faces,
  too_much_memory,
  no_triangles,
  zero_area,
  non_finite_position,
  not_orientable,
  invalid_constraint,
  no_texture_coordinates,
  does_not_fit,
  // the work
  solver_failed,
  guarantee_failed,
  time_limit,
  memory_limit,
  cancelled,
  poison,
  storage_failed,
  storage_full,
  storage_corrupt,
  internal,
  // the mesh of a request, named by its address
  source_refused,
  source_failed,
};

inline constexpr int kErrorCodeCount = static_cast<int>(ErrorCode::source_failed) + 1;

/// What went wrong, for the person who sent the request.
/// message: one sentence that says what is wrong and what to do about it.
/// where: a JSON pointer into the document or the options, or a place in the file ("line 12",
/// "byte 20"); empty when the whole input is meant.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message, std::string where = {})
      : std::runtime_error(message), code_(code), where_(std::move(where)) {}

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  [[nodiscard]] const std::string& where() const noexcept { return where_; }

 private:
  ErrorCode code_;
  std::string where_;
};

}  // namespace unwrapd
