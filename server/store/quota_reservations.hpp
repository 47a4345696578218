#pragma once
// Bytes that an owner is about to have, and that the store does not count yet: of uploads that
// come, of results that are made. They are claimed from his quota before they are written, so that
// all that is under way at once does not add up to more than he may have.

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "server/store/job_store.hpp"

namespace unwrapd::server::store {

/// Thread-safe.
class QuotaReservations {
 public:
  explicit QuotaReservations(JobStore& store) : store_(store) {}

 private:
  friend class QuotaReservation;

  /// Returns all bytes that the owner claims, with these.
  std::int64_t add(const std::string& owner, std::int64_t bytes);

  JobStore& store_;
  std::mutex mutex_;
  std::map<std::string, std::int64_t> claimed_;  // by owner
};

/// Of one upload or job, until the store counts its bytes or they are gone. Not for use by two
/// threads at once.
class QuotaReservation {
 public:
  QuotaReservation(QuotaReservations& reservations, std::string owner)
      : reservations_(reservations), owner_(std::move(owner)) {}
  QuotaReservation(const QuotaReservation&) = delete;
  QuotaReservation& operator=(const QuotaReservation&) = delete;
  ~QuotaReservation() { give_up(); }

  /// Claims so many bytes in all, if a quota of `most` (0: none) leaves them. known_bytes: of what
  /// is stored already, and takes nothing from the quota when it comes again, once at a time.
  [[nodiscard]] bool try_set(std::int64_t bytes, std::int64_t most, std::int64_t known_bytes = 0);
  /// Claims so many more. Throws Error{quota_exceeded}.
  void add(std::int64_t bytes, std::int64_t most);
  void give_up() noexcept;

  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  QuotaReservations& reservations_;
  const std::string owner_;
  std::int64_t bytes_ = 0;
};

}  // namespace unwrapd::server::store
