#pragma once
// Numbers that look random and are the same for everybody: a hash of what they are for, where a
// generator's next number would depend on who asked before.

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

}  // namespace unwrapd
