#include "server/upload_room.hpp"

#include <algorithm>

#include "server/queue_errors.hpp"

namespace unwrapd::server {

std::int64_t UploadRooms::claim(const std::string& owner, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  const std::int64_t all = claimed_[owner] += bytes;
  if (all == 0) claimed_.erase(owner);
  return all;
}

UploadRoom::~UploadRoom() {
  if (claimed_ > 0) rooms_.claim(owner_, -claimed_);
}

/// Whether the quota leaves so many bytes in all for this upload; they are then its own. What is
/// claimed is read before what is stored, so that an upload that ends meanwhile counts twice rather
/// than not at all.
bool UploadRoom::try_claim(std::int64_t bytes) {
  const std::int64_t before = claimed_;
  claimed_ = bytes;
  const std::int64_t all = rooms_.claim(owner_, claimed_ - before);
  const std::int64_t left = quota_ - rooms_.store_.usage(owner_).stored_bytes;
  const bool comes_again = size_.known_bytes > 0 && bytes <= size_.known_bytes;
  const std::int64_t new_bytes = comes_again ? all - bytes : all;
  if (new_bytes <= left || (comes_again && new_bytes == 0)) return true;
  rooms_.claim(owner_, before - claimed_);
  claimed_ = before;
  return false;
}

void UploadRoom::claim(std::int64_t bytes) {
  if (quota_ > 0 && !try_claim(bytes)) throw quota_exceeded(quota_);
}

void UploadRoom::check_declared() {
  claim(size_.declared_bytes);
  rooms_.disk_.check_upload(size_.declared_bytes);
}

/// Of a body of unknown length twice what has come is claimed where there is so much, so that the
/// store is not asked for each piece.
void UploadRoom::check_quota() {
  if (quota_ == 0 || taken_ <= claimed_) return;
  if (!try_claim(2 * taken_)) claim(taken_);
}

void UploadRoom::take(std::int64_t bytes) {
  taken_ += bytes;
  check_quota();
  if (rooms_.disk_.try_take_for_upload(upload_, bytes)) return;
  const std::int64_t whole = std::max(taken_, size_.declared_bytes);
  claim(whole);
  rooms_.disk_.take_for_upload(upload_, bytes, whole);
}

}  // namespace unwrapd::server
