#pragma once
// Which sets of faces were tried and found to have no sound map.
//
// Three quarters of all faces that a search tries end in flips or overlaps, and searches that begin
// with the same regions come to the same sets again. Only failures are kept:
// there is no map to remember of them. Rejected: unions that went well, too; 50 MB for 3 % of time.

#include <cstdint>
#include <optional>
#include <unordered_map>

#include "core/segment/base/test_parameterization.hpp"

namespace unwrapd::segment {

/// A number for the set of faces that is tried, for what is glued in it, and for whether a map of a
/// part of it stays, which may fail where a map of all of it would not. Order and seed are left
/// out: a set without a sound map from one seed hardly ever has one from another.
std::uint64_t trial_key(std::span<const char> open, const TestRules& rules, const Region& region);

/// Of one surface, for one thread.
class FailedTrials {
 public:
  FailedTrials() = default;
  /// Knows what `before` knows, which must outlive it; any number of threads may read that.
  explicit FailedTrials(const FailedTrials* before) : before_(before) {}

  /// What a trial with this key came to; nothing: it was not tried, or went well, or failed by an
  /// excess that is no more than most_excess.
  [[nodiscard]] std::optional<TestResult> find(std::uint64_t key, double most_excess) const;

  /// A result that is sound is not kept.
  void keep(std::uint64_t key, const TestResult& result);

  /// All that other knows by itself.
  void take(FailedTrials other);

 private:
  const FailedTrials* before_ = nullptr;
  std::unordered_map<std::uint64_t, TestResult> failed_;
};

}  // namespace unwrapd::segment
