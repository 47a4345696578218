#pragma once
// Meshes that are sent once and made many jobs of: stored by the digest of their bytes, for the key
// that sent them and no other. A job of one shares its document (a hard link), so that neither
// waits for the other's end; the bytes count once, for the mesh, which stays as long as a job
// shares them.

#include <mutex>
#include <string>

#include "api/mesh.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/http/http.hpp"
#include "server/results/files_on_request.hpp"
#include "server/store/job_store.hpp"
#include "server/store/mesh_store.hpp"
#include "server/uploads/upload_budget.hpp"

namespace unwrapd::server::uploads {

struct SentMesh {
  store::MeshRecord mesh;
  bool is_new = false;
};

/// Thread-safe.
class Meshes {
 public:
  Meshes(store::MeshStore& store, store::JobStore& jobs, blobs::BlobStore& blobs,
         const UploadRooms& rooms, results::Renderer& renderer)
      : store_(store),
        jobs_(jobs),
        blobs_(blobs),
        rooms_(rooms),
        renderer_(renderer),
        analyses_(blobs, renderer) {}

  /// Stores the body of a request as the mesh of this digest. Throws Error: digest_mismatch and
  /// what BodyReader throws, unsupported_media_type, unknown_format (of an empty body),
  /// quota_exceeded, storage_full, storage_failed; nothing is left then.
  SentMesh receive(const http::Request& request, const std::string& sha256);

  /// Throws Error{mesh_not_found} when the owner has none of this digest; where: for that error.
  store::MeshRecord find(const std::string& owner, const std::string& sha256,
                         const std::string& where = {});

  /// The document of a mesh becomes that of an upload, too. Throws like find(),
  /// storage_corrupt.
  store::JobInput share(const std::string& owner, const std::string& sha256,
                        const std::string& upload, const std::string& where = {});

  /// {"analysis": ...}, or {"problem": ...} for a mesh of which no job can be made; worked out
  /// once. Throws what Renderer throws.
  api::Json analysis(const store::MeshRecord& mesh, const http::HasLeft& has_left = {});

  [[nodiscard]] Moment now() const { return jobs_.now(); }
  [[nodiscard]] const FileCounts& counts() const { return analyses_.counts(); }

 private:
  [[nodiscard]] SentMesh settle(const http::Request& request, store::MeshRecord mesh,
                                const std::string& upload);

  store::MeshStore& store_;
  store::JobStore& jobs_;
  blobs::BlobStore& blobs_;
  const UploadRooms& rooms_;
  results::Renderer& renderer_;
  results::FilesOnRequest analyses_;
  std::mutex settling_;  // one upload at a time takes its name
};

}  // namespace unwrapd::server::uploads
