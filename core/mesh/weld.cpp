// Exact welding by sorting: positions are ordered by 32 bits of a hash with three counting sorts,
// then the few of equal hash by their coordinates. A hash table would be as fast, but a mesh that
// was made to collide would take quadratic time; here it only costs an ordinary sort.
#include "core/mesh/weld.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "core/mesh/counting_sort.hpp"

namespace unwrapd {
namespace {

constexpr unsigned kDigitBits = 11;  // of a hash, sorted at a time

struct Entry {
  std::uint32_t hash = 0;
  Index vertex = 0;
};

std::uint64_t mix(
    std::uint64_t x) {  // an odd multiplier and a fold, so that every bit affects the top
  x *= 0x9E3779B97F4A7C15U;
  return x ^ (x >> 32U);
}

std::uint32_t hash_of(const Vec3& p) {
  std::uint64_t h = 0;
  for (double x : p) h = mix(h ^ std::bit_cast<std::uint64_t>(x + 0.0));  // -0.0 + 0.0 is +0.0
  return static_cast<std::uint32_t>(mix(h) >> 32U);
}

void sort_by_hash(std::vector<Entry>& entries, const std::stop_token& stop) {
  for (unsigned shift = 0; shift < 32; shift += kDigitBits)
    counting_sort(
        entries, 1 << kDigitBits,
        [shift](const Entry& entry) {
          return static_cast<Index>((entry.hash >> shift) & ((1U << kDigitBits) - 1));
        },
        stop);
}

}  // namespace

std::vector<Index> weld(std::span<const Vec3> positions, const std::stop_token& stop) {
  std::vector<Entry> entries(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v)
    entries[v] = {hash_of(positions[v]), static_cast<Index>(v)};
  sort_by_hash(entries, stop);
  const auto key = [&](const Entry& entry) {
    const Vec3& p = positions[entry.vertex];
    return std::tuple(entry.hash, p.x(), p.y(), p.z(), entry.vertex);
  };
  for_each_run(
      entries, [](const Entry& a, const Entry& b) { return a.hash == b.hash; },
      [&](const Entry* first, const Entry* last) {
        if (last - first == 1) return;
        const auto begin = entries.begin() + (first - entries.data());
        std::sort(begin, begin + (last - first),
                  [&](const Entry& a, const Entry& b) { return key(a) < key(b); });
      },
      stop);
  std::vector<Index> first_at(positions.size());
  for_each_run(
      entries,
      [&](const Entry& a, const Entry& b) { return positions[a.vertex] == positions[b.vertex]; },
      [&](const Entry* first, const Entry* last) {
        for (const Entry* e = first; e != last; ++e) first_at[e->vertex] = first->vertex;
      },
      stop);
  return first_at;
}

std::vector<Triangle> renumber(std::span<const Triangle> faces, std::span<const Index> of) {
  std::vector<Triangle> result(faces.begin(), faces.end());
  for (Triangle& face : result)
    for (Index& v : face) v = of[v];
  return result;
}

}  // namespace unwrapd
