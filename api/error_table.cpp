#include "api/error_table.hpp"

#include <array>
#include <cstddef>
#include <string>

namespace unwrapd::api {
namespace {

using enum ErrorCode;

constexpr std::array kRows = {
    ErrorRow{malformed_request, "malformed_request", 400, "The request cannot be understood"},
    ErrorRow{invalid_option, "invalid_option", 422, "An option is invalid"},
    ErrorRow{not_found, "not_found", 404, "The resource does not exist"},
    ErrorRow{method_not_allowed, "method_not_allowed", 405, "The method is not allowed here"},
    ErrorRow{not_acceptable, "not_acceptable", 406, "No representation is acceptable"},
    ErrorRow{request_timeout, "request_timeout", 408, "The request took too long to arrive"},
    ErrorRow{job_unfinished, "job_unfinished", 409, "The job is not finished"},
    ErrorRow{result_expired, "result_expired", 410, "The result is no longer stored"},
    ErrorRow{length_required, "length_required", 411, "A content length is required"},
    ErrorRow{body_too_large, "body_too_large", 413, "The body is too large"},
    ErrorRow{unsupported_media_type, "unsupported_media_type", 415,
             "The media type is not supported"},
    ErrorRow{headers_too_large, "headers_too_large", 431, "The header fields are too large"},
    ErrorRow{queue_full, "queue_full", 429, "The queue is full"},
    ErrorRow{draining, "draining", 503, "The server is shutting down"},
    ErrorRow{too_many_streams, "too_many_streams", 503, "Too many event streams are open"},
    ErrorRow{unauthorized, "unauthorized", 401, "An API key is required"},
    ErrorRow{forbidden, "forbidden", 403, "The request is not allowed"},
    ErrorRow{invalid_link, "invalid_link", 403, "The link is invalid or has expired"},
    ErrorRow{idempotency_conflict, "idempotency_conflict", 409,
             "The name belongs to another request"},
    ErrorRow{rate_limited, "rate_limited", 429, "Too many requests"},
    ErrorRow{too_many_jobs, "too_many_jobs", 429, "The API key has too many jobs"},
    ErrorRow{quota_exceeded, "quota_exceeded", 507, "The storage quota is used up"},
    ErrorRow{webhook_refused, "webhook_refused", 422, "The webhook address is not allowed"},
    ErrorRow{mesh_not_found, "mesh_not_found", 404, "The mesh is not stored here"},
    ErrorRow{digest_mismatch, "digest_mismatch", 400, "The body does not match its digest"},
    ErrorRow{unknown_format, "unknown_format", 415, "The format is not recognised"},
    ErrorRow{malformed_glb, "malformed_glb", 400, "The GLB container is broken"},
    ErrorRow{malformed_json, "malformed_json", 400, "The asset's JSON is broken"},
    ErrorRow{malformed_gltf, "malformed_gltf", 400, "The glTF document is broken"},
    ErrorRow{malformed_obj, "malformed_obj", 400, "The OBJ file is broken"},
    ErrorRow{malformed_mesh, "malformed_mesh", 400, "The STL, PLY, OFF or zip file is broken"},
    ErrorRow{malformed_draco, "malformed_draco", 400, "The Draco data is broken"},
    ErrorRow{malformed_meshopt, "malformed_meshopt", 400, "The meshopt data is broken"},
    ErrorRow{malformed_image, "malformed_image", 400, "An image is broken"},
    ErrorRow{missing_buffer, "missing_buffer", 422, "A buffer of the asset is missing"},
    ErrorRow{external_uri, "external_uri", 422, "The asset refers to external data"},
    ErrorRow{unsupported_extension, "unsupported_extension", 422, "An extension is not supported"},
    ErrorRow{unsupported_image, "unsupported_image", 422, "A kind of image is not supported"},
    ErrorRow{too_many_vertices, "too_many_vertices", 413, "The mesh has too many vertices"},
    ErrorRow{too_many_faces, "too_many_faces", 413, "The mesh has too many faces"},
    ErrorRow{too_much_memory, "too_much_memory", 413, "The job needs too much memory"},
    ErrorRow{no_triangles, "no_triangles", 422, "The asset has no triangles"},
    ErrorRow{zero_area, "zero_area", 422, "The mesh has no area"},
    ErrorRow{non_finite_position, "non_finite_position", 422, "A position is not finite"},
    ErrorRow{not_orientable, "not_orientable", 422, "The surface is not orientable"},
    ErrorRow{invalid_constraint, "invalid_constraint", 422, "A constraint cannot be satisfied"},
    ErrorRow{no_texture_coordinates, "no_texture_coordinates", 422, "The asset has no UVs to pack"},
    ErrorRow{does_not_fit, "does_not_fit", 422, "The islands do not fit on the pages"},
    ErrorRow{solver_failed, "solver_failed", 500, "The solver failed"},
    ErrorRow{guarantee_failed, "guarantee_failed", 422, "The guarantee cannot be satisfied"},
    ErrorRow{time_limit, "time_limit", 422, "The job took longer than allowed"},
    ErrorRow{memory_limit, "memory_limit", 422, "The job needed more memory than allowed"},
    ErrorRow{cancelled, "cancelled", 409, "The job was cancelled"},
    ErrorRow{poison, "poison", 500, "The job crashed too often"},
    ErrorRow{storage_failed, "storage_failed", 500, "The storage failed"},
    ErrorRow{storage_full, "storage_full", 507, "The storage is full"},
    ErrorRow{storage_corrupt, "storage_corrupt", 500, "A stored file is damaged"},
    ErrorRow{internal, "internal", 500, "An internal error occurred"},
    ErrorRow{source_refused, "source_refused", 422, "The source is not allowed"},
    ErrorRow{source_failed, "source_failed", 422, "The source cannot be read"},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    if (kRows[i].code != static_cast<ErrorCode>(i)) return false;
  }
  return true;
}

static_assert(kRows.size() == kErrorCodeCount, "every ErrorCode has one row");
static_assert(in_order(), "rows stand in the order of ErrorCode");

std::string text_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::span<const ErrorRow> error_table() { return kRows; }

const ErrorRow& error_row(ErrorCode code) { return kRows[static_cast<std::size_t>(code)]; }

std::optional<ErrorCode> code_named(std::string_view name) {
  for (const ErrorRow& row : kRows) {
    if (row.name == name) return row.code;
  }
  return std::nullopt;
}

Json problem(const Error& error, std::string_view job_id) {
  const ErrorRow& row = error_row(error.code());
  Json json = {{"type", "urn:unwrapd:problem:" + std::string(row.name)},
               {"title", row.title},
               {"status", row.status},
               {"detail", error.what()},
               {"code", row.name}};
  if (!error.where().empty()) json["pointer"] = error.where();
  if (!job_id.empty()) json["job"] = job_id;
  return json;
}

Error error_from_problem(const Json& problem) {
  if (!problem.is_object()) return {ErrorCode::internal, "The answer is not a problem document."};
  const ErrorCode code = code_named(text_of(problem, "code")).value_or(ErrorCode::internal);
  std::string detail = text_of(problem, "detail");
  if (detail.empty()) detail = text_of(problem, "title");
  return {code, detail, text_of(problem, "pointer")};
}

}  // namespace unwrapd::api
