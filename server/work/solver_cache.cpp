// Values are computed outside the lock: a job that asks for a value that another job computes waits
// for this value alone.
#include "server/work/solver_cache.hpp"

#include <openssl/evp.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"

namespace unwrapd::server::work {
namespace {

/// Bytes of the machine, or of the container of this process if that has less.
std::size_t memory_of_machine() {
  std::size_t bytes = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                      static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (const char* path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream limit(path);
    std::size_t most = 0;
    if (limit >> most) bytes = std::min(bytes, most);  // "max", or no such file: no limit
  }
  return bytes;
}

std::size_t share_of(const MemoryLimits& limits, int workers) {
  if (limits.job_bytes > 0) return static_cast<std::size_t>(limits.job_bytes);
  const std::size_t all = memory_of_machine();
  const std::size_t cache = std::min(all / 2, static_cast<std::size_t>(limits.cache_bytes));
  return (all - cache) / static_cast<std::size_t>(std::max(1, workers));
}

}  // namespace

SolverCache::SolverCache(const MemoryLimits& limits, int workers)
    : most_bytes_(static_cast<std::size_t>(limits.cache_bytes)),
      job_bytes_(share_of(limits, workers)) {}

Digest SolverCache::digest(std::span<const std::byte> bytes) const {
  Digest digest;
  auto* out = reinterpret_cast<unsigned char*>(digest.data());
  if (EVP_Digest(bytes.data(), bytes.size(), out, nullptr, EVP_sha256(), nullptr) != 1)
    throw Error(ErrorCode::internal, "A digest could not be computed.");
  return digest;
}

std::shared_ptr<const void> SolverCache::obtain(const Digest& key,
                                                const std::function<Made()>& make,
                                                const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (auto found = entries_.find(key); found != entries_.end(); found = entries_.find(key)) {
    const std::shared_ptr<Entry> entry = found->second;  // it may be dropped while we wait
    const auto is_done = [&] { return entry->made.value || entry->has_failed; };
    if (!ended_.wait(lock, stop, is_done)) throw_if_cancelled(stop);
    if (entry->has_failed) continue;
    ++counters_.hits;
    const auto now = entries_.find(key);
    if (now != entries_.end() && now->second == entry)
      uses_.splice(uses_.begin(), uses_, entry->use);
    return entry->made.value;
  }
  const auto entry = std::make_shared<Entry>();
  entries_[key] = entry;
  ++counters_.misses;
  lock.unlock();
  return make_now(key, *entry, make);
}

std::shared_ptr<const void> SolverCache::make_now(const Digest& key, Entry& entry,
                                                  const std::function<Made()>& make) {
  try {
    Made made = make();
    const std::lock_guard lock(mutex_);
    entry.made = std::move(made);
    keep(key, entry);
    ended_.notify_all();
    return entry.made.value;
  } catch (...) {
    const std::lock_guard lock(mutex_);
    entry.has_failed = true;
    entries_.erase(key);
    ended_.notify_all();
    throw;
  }
}

void SolverCache::keep(const Digest& key, Entry& entry) {
  if (entry.made.bytes > most_bytes_) {  // the others stay
    entries_.erase(key);
    ++counters_.evictions;
    return;
  }
  uses_.push_front(key);
  entry.use = uses_.begin();
  counters_.bytes += entry.made.bytes;
  evict_beyond(most_bytes_);
}

void SolverCache::shrink_to(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  evict_beyond(bytes);
}

void SolverCache::evict_beyond(std::size_t bytes) {
  while (counters_.bytes > bytes) {
    const auto last = entries_.find(uses_.back());
    counters_.bytes -= last->second->made.bytes;
    entries_.erase(last);
    uses_.pop_back();
    ++counters_.evictions;
  }
}

CacheCounters SolverCache::counters() const {
  const std::lock_guard lock(mutex_);
  CacheCounters now = counters_;
  now.entries = uses_.size();
  return now;
}

}  // namespace unwrapd::server::work
