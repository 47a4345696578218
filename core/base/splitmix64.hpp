#pragma once
// Numbers that look random and are the same for everybody: a hash of what they are for, where a
// generator's next number would depend on who asked before.

#include <cstddef>
#include <cstdint>

namespace unwrapd {

/// What splitmix64 (Steele, Lea, Flood 2014) makes of the state z: a bijection on 64 bits.
constexpr std::uint64_t splitmix64(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// From one state of splitmix64 to the next: 2^64 over the golden ratio.
inline constexpr std::uint64_t kGoldenStep = 0x9e3779b97f4a7c15ULL;

/// The numbers of splitmix64 from a seed on.
class SplitMixSequence {
 public:
  explicit SplitMixSequence(std::uint64_t seed = 0) : state_(seed) {}

  std::uint64_t next() { return splitmix64(state_ += kGoldenStep); }

  /// From 0 to bound - 1, evenly spread.
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(next() % bound); }

 private:
  std::uint64_t state_;
};

}  // namespace unwrapd
