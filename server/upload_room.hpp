#pragma once
// The room of an upload, taken as its bytes come: in its owner's quota, and on the disk. Room that
// others' results must be given up for is taken only by an upload that, as far as can be told by
// then, will be accepted: its owner may have that many bytes beside all that he is sending, and
// there is room for all of them. Whatever becomes of uploads, an owner's never cost others more
// than his quota at a time.

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "server/caller.hpp"
#include "server/disk_room.hpp"
#include "server/job_store.hpp"

namespace unwrapd::server {

/// What all uploads share. Thread-safe.
class UploadRooms {
 public:
  UploadRooms(JobStore& store, DiskRoom& disk) : store_(store), disk_(disk) {}

 private:
  friend class UploadRoom;

  /// Returns all bytes that the owner's uploads claim, with these.
  std::int64_t claim(const std::string& owner, std::int64_t bytes);

  JobStore& store_;
  DiskRoom& disk_;
  std::mutex mutex_;
  std::map<std::string, std::int64_t> claimed_;  // by owner; these bytes are not stored yet
};

struct UploadSize {
  /// Of what is there already, should the upload turn out to be the same: that takes nothing from
  /// the quota.
  std::int64_t known_bytes = 0;
  std::int64_t declared_bytes = 0;  ///< of the body, 0 when not told beforehand
};

/// Of one upload, until it is stored or dropped. Not for use by two threads at once.
class UploadRoom {
 public:
  UploadRoom(UploadRooms& rooms, const Caller& caller, std::string upload, const UploadSize& size)
      : rooms_(rooms),
        owner_(caller.owner),
        quota_(caller.quota.max_bytes),
        upload_(std::move(upload)),
        size_(size) {}
  UploadRoom(const UploadRoom&) = delete;
  UploadRoom& operator=(const UploadRoom&) = delete;
  ~UploadRoom();

  /// For a body that is stored as it comes: throws what take() would come to throw.
  void check_declared();
  /// Counts bytes that are about to be written. Throws Error: quota_exceeded, storage_full.
  void take(std::int64_t bytes);

 private:
  void check_quota();
  [[nodiscard]] bool try_claim(std::int64_t bytes);
  void claim(std::int64_t bytes);

  UploadRooms& rooms_;
  const std::string owner_;
  const std::int64_t quota_;  // 0: none
  const std::string upload_;
  const UploadSize size_;
  std::int64_t claimed_ = 0;  // of the quota
  std::int64_t taken_ = 0;
};

}  // namespace unwrapd::server
