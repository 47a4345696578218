#pragma once
// The solver core that all workers share: factors and maps by the SHA-256 of what they are made
// from, the least recently used ones dropped when they take more bytes than they may.

#include <condition_variable>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>

#include "core/base/shared_cache.hpp"

namespace unwrapd::server::work {

/// bytes: of what is kept now; the others count since the start.
struct CacheCounters {
  std::uint64_t hits = 0;       ///< what was asked for was there, or was being made
  std::uint64_t misses = 0;     ///< it was made
  std::uint64_t evictions = 0;  ///< it was dropped to keep within the limit
  std::size_t entries = 0;
  std::size_t bytes = 0;
};

struct MemoryLimits {
  std::int64_t cache_bytes = std::int64_t{256} << 20;  ///< of all that is kept for further jobs
  std::int64_t job_bytes = 0;  ///< that one job may take; 0: its share of the machine
};

class SolverCache final : public SharedCache {
 public:
  /// Values larger than the cache are returned but not cached. workers: jobs that share the
  /// machine's memory.
  SolverCache(const MemoryLimits& limits, int workers);

  [[nodiscard]] Digest digest(std::span<const std::byte> bytes) const override;
  std::shared_ptr<const void> obtain(const Digest& key, const std::function<Made()>& make,
                                     const std::stop_token& stop) override;
  [[nodiscard]] std::size_t memory_limit() const override { return job_bytes_; }

  /// Drops the least recently used until the others take no more bytes than that.
  void shrink_to(std::size_t bytes);
  [[nodiscard]] CacheCounters counters() const;

 private:
  /// Without a value: being made by some job, or that failed.
  struct Entry {
    Made made{};
    bool has_failed = false;
    std::list<Digest>::iterator use{};  ///< among uses_, once there is a value
  };

  std::shared_ptr<const void> make_now(const Digest& key, Entry& entry,
                                       const std::function<Made()>& make);
  void keep(const Digest& key, Entry& entry);
  void evict_beyond(std::size_t bytes);

  const std::size_t most_bytes_, job_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable_any ended_;  ///< something was made, or that failed
  std::map<Digest, std::shared_ptr<Entry>> entries_;
  std::list<Digest> uses_;  ///< the most recent first
  CacheCounters counters_;
};

}  // namespace unwrapd::server::work
