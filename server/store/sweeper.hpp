#pragma once
// Removes what is kept long enough: first the files of a finished job (410 from then on), and after
// as long again the job itself (404); and meshes that were not used for so long. Where the disk may
// hold only so much, the files of the job that ended first, or that mesh, go earlier.

#include <chrono>
#include <cstdint>

#include "server/base/log.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/store/job_store.hpp"
#include "server/store/mesh_store.hpp"

namespace unwrapd::server::store {

/// One sweep at this time, of Moment::kept_ms().
void sweep(JobStore& store, blobs::BlobStore& blobs, std::int64_t now_ms,
           std::chrono::seconds keep);

/// The same of stored meshes: those that were not used for so long, and that no job shares.
void sweep(MeshStore& meshes, blobs::BlobStore& blobs, std::int64_t now_ms,
           std::chrono::seconds keep);

/// Gives up what is in DIR/lost, then the files of the job that ended first, or the mesh that is
/// unused for longer and that no job shares; false when there is nothing.
bool evict_oldest(JobStore& store, MeshStore& meshes, blobs::BlobStore& blobs);

/// Before anything else has files, or where other nodes have some: BlobStore::sweep() by the rows
/// of both, and what it has done is told.
void sweep_at_start(JobStore& store, MeshStore& meshes, blobs::BlobStore& blobs, const Log& log);

/// Sweeps, whatever the time of day is set to, and has it noted when it was.
class Sweeper {
 public:
  Sweeper(JobStore& store, MeshStore& meshes, blobs::BlobStore& blobs, const Log& log,
          std::chrono::seconds keep)
      : store_(store), meshes_(meshes), blobs_(blobs), log_(log), keep_(keep) {}

  /// How long to wait between two sweeps.
  [[nodiscard]] std::chrono::milliseconds pause() const;
  void sweep_once();

 private:
  void note_time();

  JobStore& store_;
  MeshStore& meshes_;
  blobs::BlobStore& blobs_;
  const Log& log_;
  const std::chrono::seconds keep_;
};

}  // namespace unwrapd::server::store
