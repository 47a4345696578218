#pragma once
// Which job of an owner a node begins that keeps its work on meshes: one that another node has
// worked on before is left to that node for a moment.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "server/store/job_store.hpp"

namespace unwrapd::server::jobs {

/// Jobs that have begun here on a mesh that some node has worked on lately.
struct AffinityCounts {
  std::uint64_t hits = 0;    ///< this node
  std::uint64_t misses = 0;  ///< another one, which was busy
};

/// Not thread-safe, but for its counts. Waits are counted by the clock of this node alone.
class Affinity {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::milliseconds kWait{250};  ///< for the node that knows the mesh
  static constexpr int kLook = 16;                        ///< jobs at the head of the owner's queue

  /// The job to begin; none: all are left to others for now. jobs: the first of the owner, in their
  /// order.
  std::optional<store::WaitingJob> choose(const std::vector<store::WaitingJob>& jobs,
                                          Clock::time_point now);
  /// Counts a job that has begun.
  void count(const store::WaitingJob& job);

  [[nodiscard]] AffinityCounts counts() const { return {hits_, misses_}; }

 private:
  std::map<std::int64_t, Clock::time_point> left_;  ///< jobs, and since when
  std::atomic<std::uint64_t> hits_ = 0, misses_ = 0;
};

}  // namespace unwrapd::server::jobs
