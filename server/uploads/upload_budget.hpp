#pragma once
// The room of an upload, taken as its bytes come: in its owner's quota, and on the disk. Room that
// others' results must be given up for is taken only by an upload that, as far as can be told by
// then, will be accepted: its owner may have that many bytes beside all that is his, and there is
// room for all of them. Whatever becomes of uploads, an owner's never cost others more than his
// quota at a time.

#include <cstdint>
#include <string>

#include "server/http/caller.hpp"
#include "server/store/disk_budget.hpp"
#include "server/store/quota_reservations.hpp"
#include "server/store/upload_meter.hpp"

namespace unwrapd::server::uploads {

/// What all uploads share.
struct UploadRooms {
  store::QuotaReservations& reservations;
  store::DiskBudget& disk;
};

struct UploadSize {
  /// Of what is there already, should the upload turn out to be the same: that is beyond the quota
  /// once at a time, and more often where nothing must be given up for it.
  std::int64_t known_bytes = 0;
  std::int64_t declared_bytes = 0;  ///< of the body, 0 when not told beforehand
};

/// Of one upload, until it is stored or dropped. Not for use by two threads at once.
class UploadBudget {
 public:
  UploadBudget(const UploadRooms& rooms, const http::Caller& caller, std::string upload,
               const UploadSize& size)
      : disk_(rooms.disk),
        quota_(caller.quota.max_bytes),
        upload_(std::move(upload)),
        size_(size),
        reservation_(rooms.reservations, caller.owner) {}

  /// For a body that is stored as it comes: throws what take() would come to throw.
  void check_declared();
  /// Counts bytes that are about to be written. Throws Error: quota_exceeded, storage_full.
  void take(std::int64_t bytes);
  /// Of them, some are gone again.
  void put_back(std::int64_t bytes);
  /// The same two, for who writes. Not beyond the life of this.
  [[nodiscard]] store::UploadMeter counter();

 private:
  [[nodiscard]] bool reservation(std::int64_t bytes);
  void claim_ahead(std::int64_t all);

  store::DiskBudget& disk_;
  const std::int64_t quota_;  // 0: none
  const std::string upload_;
  const UploadSize size_;
  store::QuotaReservation reservation_;
  std::int64_t taken_ = 0;
};

}  // namespace unwrapd::server::uploads
