#pragma once
// The disk room of one upload, taken as its bytes come. Room that others' results must be given up
// for is taken only by an upload that, as far as can be told by then, will be accepted: its key may
// have that many bytes, and there is room for all of them.

#include <cstdint>
#include <limits>
#include <string>

#include "server/caller.hpp"
#include "server/disk_room.hpp"
#include "server/job_store.hpp"

namespace unwrapd::server {

/// Bytes that an owner may still store.
struct Allowance {
  std::int64_t left = std::numeric_limits<std::int64_t>::max();
  std::int64_t most = 0;  ///< of all that is stored for him, for the error that says so
};

/// known_bytes: of what is there already, should the upload turn out to be the same: that takes
/// nothing from the quota.
Allowance allowance_of(JobStore& store, const Caller& caller, std::int64_t known_bytes);

/// Not for use by two threads at once.
class UploadRoom {
 public:
  /// declared: bytes of the body, 0 when not told beforehand.
  UploadRoom(DiskRoom& room, std::string upload, const Allowance& allowance, std::int64_t declared)
      : room_(room), upload_(std::move(upload)), allowance_(allowance), declared_(declared) {}

  /// For a body that is stored as it comes: throws what take() would come to throw.
  void check_declared() const;
  /// Counts bytes that are about to be written. Throws Error: quota_exceeded, storage_full.
  void take(std::int64_t bytes);

 private:
  void check_quota(std::int64_t bytes) const;

  DiskRoom& room_;
  const std::string upload_;
  const Allowance allowance_;
  const std::int64_t declared_;
  std::int64_t taken_ = 0;
};

}  // namespace unwrapd::server
