#include "core/pack/pack_stacked.hpp"

#include <utility>

#include "core/pack/congruent_islands.hpp"

namespace unwrapd::pack {
namespace {

Placement on_top(const Placement& first, const CongruentIsland& same) {
  return {first.cosine * same.cosine - first.sine * same.sine,
          first.sine * same.cosine + first.cosine * same.sine, first.scale, first(same.offset)};
}

}  // namespace

PackResult pack_stacked(
    std::span<const charts::Outline> islands, Rotation rotation,
    const std::function<PackResult(std::span<const charts::Outline>)>& pack_shapes,
    const std::stop_token& stop) {
  const std::vector<CongruentIsland> same = congruent_islands(islands, rotation, stop);
  std::vector<charts::Outline> shapes;
  std::vector<std::size_t> shape_of(islands.size());
  for (std::size_t k = 0; k < islands.size(); ++k)
    if (same[k].as == static_cast<Index>(k)) {
      shape_of[k] = shapes.size();
      shapes.push_back(islands[k]);
    }
  for (std::size_t k = 0; k < islands.size(); ++k) {
    const auto first = static_cast<std::size_t>(same[k].as);
    if (first == k) continue;
    shape_of[k] = shape_of[first];
    for (const auto& [a, b] : islands[k]) shapes[shape_of[k]].push_back({same[k](a), same[k](b)});
  }
  PackResult packed = pack_shapes(shapes);
  std::vector<Placement> placements(islands.size());
  packed.is_stacked.assign(islands.size(), 0);
  for (std::size_t k = 0; k < islands.size(); ++k) {
    placements[k] = on_top(packed.placements[shape_of[k]], same[k]);
    packed.is_stacked[k] = same[k].as == static_cast<Index>(k) ? 0 : 1;
  }
  packed.placements = std::move(placements);
  return packed;
}

}  // namespace unwrapd::pack
