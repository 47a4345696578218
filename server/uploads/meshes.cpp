#include "server/uploads/meshes.hpp"

#include "api/error_table.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/http/media_types.hpp"
#include "server/uploads/job_input.hpp"

namespace unwrapd::server::uploads {
namespace {

constexpr std::string_view kAnalysisFile = "analysis.json";

/// Throws Error{unsupported_media_type} unless the type is that of an asset.
std::string media_type_of(const http::Request& request) {
  const std::string type = request.header("Content-Type");
  if (http::body_kind(type) != http::BodyKind::asset) {
    throw Error(ErrorCode::unsupported_media_type,
                "A mesh is stored as one file; send it as model/gltf-binary, model/gltf+json, "
                "model/obj or application/octet-stream.");
  }
  return type.empty() ? "application/octet-stream" : type;
}

void check_digest(const std::string& is, const std::string& expected) {
  if (is == expected) return;
  throw Error(ErrorCode::digest_mismatch,
              "The SHA-256 of the body is " + is +
                  ", not the one in the address; send the complete file to its own address.");
}

/// Too much time or memory is a problem of the mesh like any other.
std::string analyse(const results::Renderer& renderer, const store::JobRecord& job,
                    const http::HasLeft& has_left) {
  try {
    return renderer.analyse(job, has_left);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::time_limit && error.code() != ErrorCode::memory_limit) throw;
    return api::Json{{"problem", api::problem(error)}}.dump();
  }
}

Error no_mesh(const std::string& where) {
  return {ErrorCode::mesh_not_found,
          "No mesh with this SHA-256 is stored; send it by PUT /v1/meshes/{sha256}.", where};
}

/// The mesh as a job with default options, for the renderer.
store::JobRecord as_job(const store::MeshRecord& mesh) {
  store::JobRecord job;
  job.id = mesh.id;
  job.owner = mesh.owner;
  job.options = api::Json::object();
  job.input = {.sha256 = mesh.sha256, .bytes = mesh.bytes, .buffers = {}};
  return job;
}

}  // namespace

SentMesh Meshes::receive(const http::Request& request, const std::string& sha256) {
  store::MeshRecord mesh;
  mesh.id = random_mesh_id();
  mesh.owner = request.caller.owner;
  mesh.media_type = media_type_of(request);
  const std::string upload = mesh.id;
  const std::optional<store::MeshRecord> known = store_.find(mesh.owner, sha256);
  UploadBudget room(
      rooms_, request.caller, upload,
      {.known_bytes = known ? known->bytes : 0, .declared_bytes = request.declared_bytes});
  room.check_declared();
  try {
    const store::UploadFolder folder{.path = blobs_.begin_upload(upload), .room = room.counter()};
    const store::JobInput came = receive_asset(*request.body, folder).input;
    check_digest(came.sha256, sha256);
    mesh.sha256 = came.sha256;
    mesh.bytes = mesh.stored_bytes = came.bytes;
    const Moment now = jobs_.now();
    mesh.created_ms = now.of_day_ms;
    mesh.kept_since_ms = now.kept_ms();
    return settle(request, std::move(mesh), upload);
  } catch (...) {
    blobs_.drop_upload(upload);
    throw;
  }
}

/// A stored mesh that is whole stays, as jobs may share its files; a damaged one is replaced.
SentMesh Meshes::settle(const http::Request& request, store::MeshRecord mesh,
                        const std::string& upload) {
  const std::lock_guard lock(settling_);
  const std::optional<store::MeshRecord> known = store_.find(mesh.owner, mesh.sha256);
  if (known && results::find_whole(blobs_, known->id, std::string(blobs::kDocumentFile))) {
    store_.use(known->id, mesh.kept_since_ms, mesh.media_type);
    blobs_.drop_upload(upload);
    return {.mesh = find(mesh.owner, mesh.sha256), .is_new = false};
  }
  const std::int64_t most = request.caller.quota.max_bytes;
  if (most > 0 && !known && jobs_.usage(mesh.owner).stored_bytes + mesh.bytes > most)
    throw quota_exceeded(most);  // a damaged one has counted already
  blobs_.keep_upload(upload, mesh.id, {{std::string(blobs::kDocumentFile), mesh.sha256}});
  try {
    store_.put(mesh);
  } catch (const StoreAway& away) {
    if (!away.in_doubt()) blobs_.remove(mesh.id);
    throw;
  } catch (...) {
    blobs_.remove(mesh.id);
    throw;
  }
  if (known) blobs_.remove(known->id);
  return {.mesh = std::move(mesh), .is_new = true};
}

store::MeshRecord Meshes::find(const std::string& owner, const std::string& sha256,
                               const std::string& where) {
  std::optional<store::MeshRecord> mesh = store_.find(owner, sha256);
  if (!mesh) throw no_mesh(where);
  return std::move(*mesh);
}

store::JobInput Meshes::share(const std::string& owner, const std::string& sha256,
                              const std::string& upload, const std::string& where) {
  const store::MeshRecord mesh = find(owner, sha256, where);
  if (!blobs_.share_document(mesh.id, upload)) throw no_mesh(where);
  if (!results::find_whole(blobs_, mesh.id, std::string(blobs::kDocumentFile))) {
    throw Error(ErrorCode::storage_corrupt,
                "The stored mesh is damaged; send it again by PUT /v1/meshes/{sha256}.", where);
  }
  store_.use(mesh.id, jobs_.now().kept_ms());
  return {.sha256 = mesh.sha256, .bytes = mesh.bytes, .buffers = {}};
}

api::Json Meshes::analysis(const store::MeshRecord& mesh, const http::HasLeft& has_left) {
  const store::JobRecord job = as_job(mesh);
  const results::StoredResult kept =
      analyses_.open(job, {.file = std::string(kAnalysisFile), .has_left = has_left},
                     [&] { return analyse(renderer_, job, has_left); });
  return api::Json::parse(kept.file->read(0, static_cast<std::size_t>(kept.file->size())));
}

}  // namespace unwrapd::server::uploads
