#include "server/upload_room.hpp"

#include <algorithm>

#include "server/queue_errors.hpp"

namespace unwrapd::server {

bool UploadRoom::try_claim(std::int64_t bytes) {
  return claim_.try_set(bytes, quota_, size_.known_bytes);
}

void UploadRoom::claim(std::int64_t bytes) {
  if (!try_claim(bytes)) throw quota_exceeded(quota_);
}

void UploadRoom::check_declared() {
  claim(size_.declared_bytes);
  disk_.check_upload(size_.declared_bytes);
}

/// Of a body of unknown length twice what has come is claimed where there is so much, so that the
/// store is not asked for each piece.
void UploadRoom::claim_ahead(std::int64_t all) {
  if (all <= claim_.bytes()) return;
  if (!try_claim(2 * all)) claim(all);
}

void UploadRoom::take(std::int64_t bytes) {
  const std::int64_t all = taken_ + bytes;
  claim_ahead(all);
  if (!disk_.try_take_for_upload(upload_, bytes)) {
    const std::int64_t whole = std::max(all, size_.declared_bytes);
    claim(whole);
    disk_.take_for_upload(upload_, bytes, whole);
  }
  taken_ = all;
}

void UploadRoom::put_back(std::int64_t bytes) {
  taken_ -= bytes;
  disk_.put_back(upload_, bytes);
}

TakeRoom UploadRoom::counter() {
  return {.take = [this](std::int64_t bytes) { take(bytes); },
          .put_back = [this](std::int64_t bytes) { put_back(bytes); }};
}

}  // namespace unwrapd::server
