#include "server/uploads/upload_budget.hpp"

#include <algorithm>
#include <string>

#include "server/base/errors.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::uploads {

/// False for a repeated upload without quota, for which no other result is removed. Throws
/// Error{quota_exceeded} for any other upload without quota.
bool UploadBudget::reservation(std::int64_t bytes) {
  if (reservation_.try_set(bytes, quota_, size_.known_bytes)) return true;
  if (bytes > size_.known_bytes) throw quota_exceeded(quota_);
  return false;
}

void UploadBudget::check_most(std::int64_t bytes) const {
  if (size_.most_bytes == 0 || bytes <= size_.most_bytes) return;
  throw Error(ErrorCode::body_too_large, "The upload ticket is for at most " +
                                             std::to_string(size_.most_bytes) +
                                             " bytes; ask for a larger one.");
}

void UploadBudget::check_declared() {
  check_most(size_.declared_bytes);
  static_cast<void>(reservation(size_.declared_bytes));
  disk_.check_upload(size_.declared_bytes);
}

/// Reserves twice the bytes received of a body of unknown length, if the quota allows it, so that
/// the store is not asked for each piece.
void UploadBudget::claim_ahead(std::int64_t all) {
  if (all <= reservation_.bytes()) return;
  if (!reservation_.try_set(2 * all, quota_)) static_cast<void>(reservation(all));
}

void UploadBudget::take(std::int64_t bytes) {
  const std::int64_t all = taken_ + bytes;
  check_most(all);
  claim_ahead(all);
  if (!disk_.try_take_for_upload(upload_, bytes)) {
    const std::int64_t whole = std::max(all, size_.declared_bytes);
    if (!reservation(whole)) throw Error(ErrorCode::storage_full, std::string(kStorageFull));
    disk_.take_for_upload(upload_, bytes, whole);
  }
  taken_ = all;
}

void UploadBudget::put_back(std::int64_t bytes) {
  taken_ -= bytes;
  disk_.put_back(upload_, bytes);
}

store::UploadMeter UploadBudget::counter() {
  return {.take = [this](std::int64_t bytes) { take(bytes); },
          .put_back = [this](std::int64_t bytes) { put_back(bytes); }};
}

}  // namespace unwrapd::server::uploads
