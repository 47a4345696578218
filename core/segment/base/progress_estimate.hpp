#pragma once
// Progress estimate for a search of unknown length. Work is counted in faces that were mapped to
// try something, the one thing that takes time; each part of the search has a share of the whole,
// and a guess of what it takes.

#include <cstddef>
#include <functional>
#include <utility>

namespace unwrapd::segment {

class ProgressEstimate {
 public:
  /// tell(share): a share of the whole, [0, 1], that never goes back.
  explicit ProgressEstimate(std::function<void(double)> tell) : tell_(std::move(tell)) {}

  /// The part before is over. This one has a share of what is left of the whole, in (0, 1], and is
  /// thought to take so many faces: up to most of the guess each counts alike, beyond it ever less.
  void begin(double share_of_rest, double guess);

  void add(std::size_t faces);

  /// Faces of the part that began last.
  [[nodiscard]] double done() const { return done_; }

 private:
  [[nodiscard]] double share() const;

  std::function<void(double)> tell_;  ///< may be empty
  double begin_ = 0, end_ = 0, guess_ = 1, done_ = 0;
};

}  // namespace unwrapd::segment
