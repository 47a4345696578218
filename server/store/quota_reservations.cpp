#include "server/store/quota_reservations.hpp"

#include "server/base/errors.hpp"

namespace unwrapd::server::store {

std::int64_t QuotaReservations::add(const std::string& owner, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  const std::int64_t all = claimed_[owner] += bytes;
  if (all == 0) claimed_.erase(owner);
  return all;
}

/// What is claimed is read before what is stored, so that an upload that ends meanwhile counts
/// twice rather than not at all.
bool QuotaReservation::try_set(std::int64_t bytes, std::int64_t most, std::int64_t known_bytes) {
  if (most == 0) return true;
  const std::int64_t all = reservations_.add(owner_, bytes - bytes_);
  std::int64_t left = most;
  try {
    left -= reservations_.store_.usage(owner_).stored_bytes;
  } catch (...) {
    reservations_.add(owner_, bytes_ - bytes);
    throw;
  }
  const bool comes_again = known_bytes > 0 && bytes <= known_bytes;
  const std::int64_t new_bytes = comes_again ? all - bytes : all;
  if (new_bytes <= left || (comes_again && new_bytes == 0)) {
    bytes_ = bytes;
    return true;
  }
  reservations_.add(owner_, bytes_ - bytes);
  return false;
}

void QuotaReservation::add(std::int64_t bytes, std::int64_t most) {
  if (!try_set(bytes_ + bytes, most)) throw quota_exceeded(most);
}

void QuotaReservation::give_up() noexcept {
  if (bytes_ > 0) reservations_.add(owner_, -bytes_);
  bytes_ = 0;
}

}  // namespace unwrapd::server::store
