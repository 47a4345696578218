#pragma once
// The room of an upload in its owner's quota and on the disk, taken as the bytes arrive. Room for
// which others' results must be removed is taken only by an upload that will be accepted, as far as
// is known by then: the quota of its owner allows its bytes, and there is room for all of them. So
// the uploads of an owner, whatever becomes of them, never cost others more than the quota at a
// time.

#include <cstdint>
#include <string>

#include "server/blobs/disk_budget.hpp"
#include "server/http/http.hpp"
#include "server/store/quota_reservations.hpp"
#include "server/store/upload_meter.hpp"

namespace unwrapd::server::uploads {

/// Shared by all uploads.
struct UploadRooms {
  store::QuotaReservations& reservations;
  blobs::DiskBudget& disk;
};

struct UploadSize {
  /// Of what is there already, should the upload turn out to be the same: that is beyond the quota
  /// once at a time, and more often where nothing must be given up for it.
  std::int64_t known_bytes = 0;
  std::int64_t declared_bytes = 0;  ///< of the body, 0 when not told beforehand
  std::int64_t most_bytes = 0;      ///< that it may bring; 0: as many as all may
};

/// The budget of one upload, until it is stored or dropped. Not for use by two threads at once.
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
  /// Counts bytes that are about to be written. Throws Error: body_too_large, quota_exceeded,
  /// storage_full.
  void take(std::int64_t bytes);
  /// Counts bytes that were removed again.
  void put_back(std::int64_t bytes);
  /// The same two functions, for the writer of the upload. Must not outlive this object.
  [[nodiscard]] store::UploadMeter counter();

 private:
  void check_most(std::int64_t bytes) const;
  [[nodiscard]] bool reservation(std::int64_t bytes);
  void claim_ahead(std::int64_t all);

  blobs::DiskBudget& disk_;
  const std::int64_t quota_;  // 0: none
  const std::string upload_;
  const UploadSize size_;
  store::QuotaReservation reservation_;
  std::int64_t taken_ = 0;
};

}  // namespace unwrapd::server::uploads
