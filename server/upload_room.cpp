#include "server/upload_room.hpp"

#include <algorithm>

#include "server/queue_errors.hpp"

namespace unwrapd::server {

Allowance allowance_of(JobStore& store, const Caller& caller, std::int64_t known_bytes) {
  const std::int64_t most = caller.quota.max_bytes;
  if (most == 0) return {};
  const std::int64_t left = most - store.usage(caller.owner).stored_bytes;
  return {.left = std::max(left, known_bytes), .most = most};
}

void UploadRoom::check_quota(std::int64_t bytes) const {
  if (bytes > allowance_.left) throw quota_exceeded(allowance_.most);
}

void UploadRoom::check_declared() const {
  check_quota(declared_);
  room_.check_upload(declared_);
}

void UploadRoom::take(std::int64_t bytes) {
  taken_ += bytes;
  check_quota(taken_);
  if (room_.try_take_for_upload(upload_, bytes)) return;
  const std::int64_t whole = std::max(taken_, declared_);
  check_quota(whole);
  room_.take_for_upload(upload_, bytes, whole);
}

}  // namespace unwrapd::server
