#include "core/guarantee/overlapping_sheets.hpp"

#include <algorithm>
#include <map>

namespace unwrapd::guarantee {
namespace {

using Pair = std::array<Index, 2>;
using Sheets = std::array<std::vector<Index>, 2>;

constexpr Index kNone = -1;

/// One number a face: which region of overlapping faces it is in, kNone for others.
std::vector<Index> regions_of(const charts::Chart& chart, const std::vector<Pair>& pairs) {
  std::vector<Index> region(chart.mesh.faces.size(), kNone);
  std::vector<char> is_open(region.size(), 0);
  for (const auto& [s, t] : pairs) is_open[s] = is_open[t] = 1;
  Index count = 0;
  std::vector<Index> reached;
  for (const auto& [s, t] : pairs)
    for (const Index first : {s, t}) {
      if (is_open[first] == 0) continue;
      reached.assign(1, first);
      is_open[first] = 0;
      for (std::size_t k = 0; k < reached.size(); ++k) {
        region[reached[k]] = count;
        for (Index h = 3 * reached[k]; h < 3 * reached[k] + 3; ++h) {
          const Index twin = chart.halfedges.twin[h];
          if (twin == kNoTwin || is_open[face_of(twin)] == 0) continue;
          is_open[face_of(twin)] = 0;
          reached.push_back(face_of(twin));
        }
      }
      ++count;
    }
  return region;
}

Pair regions_at(const Pair& pair, const std::vector<Index>& region) {
  const auto [low, high] = std::minmax(region[pair[0]], region[pair[1]]);
  return {low, high};
}

/// The two regions with the most pairs between them; equal ones if that is a region that lies on
/// itself.
Pair most_entangled(const std::vector<Index>& region, const std::vector<Pair>& pairs) {
  std::map<Pair, std::size_t> count;
  for (const Pair& pair : pairs) ++count[regions_at(pair, region)];
  return std::ranges::max_element(count, {}, [](const auto& own) { return own.second; })->first;
}

/// Grows both sheets from a pair, side by side, as long as neither lies on itself.
Sheets grown(const charts::Chart& chart, const std::vector<Pair>& pairs, const Pair& from) {
  std::vector<std::vector<Index>> on(chart.mesh.faces.size());
  for (const auto& [s, t] : pairs) on[s].push_back(t), on[t].push_back(s);
  std::vector<Index> sheet(chart.mesh.faces.size(), kNone);
  std::vector<Index> reached{from[0], from[1]};
  sheet[reached[0]] = 0;
  sheet[reached[1]] = 1;
  for (std::size_t k = 0; k < reached.size(); ++k)
    for (Index h = 3 * reached[k]; h < 3 * reached[k] + 3; ++h) {
      const Index twin = chart.halfedges.twin[h], own = sheet[reached[k]];
      const Index next = twin == kNoTwin ? kNone : face_of(twin);
      if (next == kNone || sheet[next] != kNone || on[next].empty()) continue;
      if (std::ranges::any_of(on[next], [&](Index t) { return sheet[t] == own; })) continue;
      sheet[next] = own;
      reached.push_back(next);
    }
  Sheets sheets;
  for (const Index t : reached) sheets[static_cast<std::size_t>(sheet[t])].push_back(t);
  return sheets;
}

}  // namespace

Sheets overlapping_sheets(const charts::Chart& chart, const std::vector<Pair>& pairs) {
  const std::vector<Index> region = regions_of(chart, pairs);
  const Pair most = most_entangled(region, pairs);
  const auto [a, b] = most;
  if (a == b)
    return grown(chart, pairs, *std::ranges::find_if(pairs, [&](const Pair& pair) {
                   return regions_at(pair, region) == most;
                 }));
  Sheets sheets;
  for (std::size_t t = 0; t < region.size(); ++t)
    if (region[t] == a || region[t] == b)
      sheets[region[t] == a ? 0 : 1].push_back(static_cast<Index>(t));
  return sheets;
}

}  // namespace unwrapd::guarantee
