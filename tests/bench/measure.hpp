#pragma once
// What the benchmarks share: a mesh of any size, a clock, the peak of memory.

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <utility>

#include "core/base/executor.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::bench {

/// A bumpy open surface of about `faces` triangles.
inline TriMesh surface(double faces) {
  const auto side = static_cast<Index>(std::lround(std::sqrt(faces / 2)));
  return shapes::mapped_grid(side, side, shapes::Wrap::none, [](double u, double v) {
    return Vec3(u, v,
                0.2 * std::sin(7 * u + 2 * v) * std::cos(5 * v) + 0.02 * std::sin(40 * u * v));
  });
}

/// The greatest resident set of this process so far.
inline double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Seconds that this process has kept processors busy.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Seconds that this thread has kept a processor busy.
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One thread that tells what two would take: blocks are timed one by one and dealt to whichever of
/// the two would be free first. On a busy machine the wall clock tells nothing. What waking threads
/// and sharing the memory cost is left out.
class DealtToTwo final : public Executor {
 public:
  explicit DealtToTwo(SharedCache* core = nullptr) : core_(core) {}

  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    double busy[2] = {0, 0}, last = thread_seconds();
    for (int block = 0; block < block_count; ++block) {
      body(block);
      const double now = thread_seconds();
      busy[busy[1] < busy[0] ? 1 : 0] += now - std::exchange(last, now);
    }
    saved_ += std::min(busy[0], busy[1]);
  }
  [[nodiscard]] SharedCache* shared_cache() const override { return core_; }

  /// Seconds that the second thread would have saved so far.
  [[nodiscard]] double saved() const { return saved_; }

 private:
  SharedCache* core_;
  double saved_ = 0;
};

}  // namespace unwrapd::bench
