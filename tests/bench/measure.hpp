#pragma once
// What the benchmarks share: a mesh of any size, a clock, the peak of memory.

#include <sys/resource.h>

#include <chrono>
#include <cmath>

#include "tests/core/shapes.hpp"

namespace unwrapd::bench {

/// A bumpy open surface of about `faces` triangles.
inline TriMesh sheet(double faces) {
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

}  // namespace unwrapd::bench
