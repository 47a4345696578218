#pragma once
// Bytes that an owner is about to have and that the store does not count yet: of uploads, and of
// results that are written. They are reserved in the quota before they are written, so that
// concurrent uploads and jobs do not exceed it together.

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

  /// Adds bytes. Returns all that the owner has reserved.
  std::int64_t add(const std::string& owner, std::int64_t bytes);

  JobStore& store_;
  std::mutex mutex_;
  std::map<std::string, std::int64_t> claimed_;  // by owner
};

/// The reservation of one upload or job, until the store counts its bytes or they are removed. Not
/// for use by two threads at once.
class QuotaReservation {
 public:
  QuotaReservation(QuotaReservations& reservations, std::string owner)
      : reservations_(reservations), owner_(std::move(owner)) {}
  QuotaReservation(const QuotaReservation&) = delete;
  QuotaReservation& operator=(const QuotaReservation&) = delete;
  ~QuotaReservation() { give_up(); }

  /// Sets the reservation to so many bytes if a quota of `most` (0: none) allows it. known_bytes:
  /// of a file that is stored already; one upload of it at a time takes nothing from the quota.
  [[nodiscard]] bool try_set(std::int64_t bytes, std::int64_t most, std::int64_t known_bytes = 0);
  /// Adds so many bytes. Throws Error{quota_exceeded}.
  void add(std::int64_t bytes, std::int64_t most);
  void give_up() noexcept;

  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  QuotaReservations& reservations_;
  const std::string owner_;
  std::int64_t bytes_ = 0;
};

}  // namespace unwrapd::server::store
