#include "core/solve/arap/face_blocks.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"
#include "core/mesh/counting_sort.hpp"

namespace unwrapd::solve::arap {
namespace {

constexpr Index kNone = -1;

using linear::at;

/// Faces sorted by the lowest rank of their corners; ties keep their order.
std::vector<Index> sorted_faces(std::span<const Triangle> faces, std::span<const Index> rank,
                                const std::stop_token& stop, std::vector<Index>& lowest) {
  lowest.reserve(faces.size());
  for (const auto& [a, b, c] : faces)
    lowest.push_back(std::min({rank[at(a)], rank[at(b)], rank[at(c)]}));
  std::vector<Index> sorted(faces.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  counting_sort(
      sorted, static_cast<Index>(rank.size()), [&](Index t) { return lowest[at(t)]; }, stop);
  return sorted;
}

class Builder {
 public:
  Builder(std::span<const measure::RestTriangle> rest, std::span<const Triangle> faces,
          std::span<const Index> rank)
      : rest_(rest), faces_(faces), rank_(rank), number_(rank.size(), kNone) {}

  FaceBlocks build(const std::stop_token& stop) && {
    std::vector<Index> lowest;
    const std::vector<Index> sorted = sorted_faces(faces_, rank_, stop, lowest);
    const auto vertex_count = static_cast<Index>(rank_.size());
    auto begin = sorted.begin();
    blocks_.groups.reserve(sorted.size() / kFacesAbreast + at(vertex_count / FaceBlocks::kOwn) + 1);
    for (Index first = 0; first < vertex_count; first += FaceBlocks::kOwn) {
      throw_if_cancelled(stop);
      const Index own = std::min(FaceBlocks::kOwn, vertex_count - first);
      const auto end = std::partition_point(begin, sorted.end(),
                                            [&](Index t) { return lowest[at(t)] < first + own; });
      add_block(first, own, std::span(begin, end));
      begin = end;
    }
    return std::move(blocks_);
  }

 private:
  void add_block(Index first, Index own, std::span<const Index> faces) {
    FaceBlock block{first, own, blocks_.beyond.size(), 0, blocks_.groups.size(), 0};
    for (std::size_t k = 0; k < faces.size(); k += kFacesAbreast)
      add_group(block, faces.subspan(k, std::min(kFacesAbreast, faces.size() - k)));
    block.beyond_end = blocks_.beyond.size();
    block.group_end = blocks_.groups.size();
    for (std::size_t k = block.beyond_begin; k < block.beyond_end; ++k)
      number_[at(blocks_.beyond[k])] = kNone;
    blocks_.all.push_back(block);
  }

  void add_group(const FaceBlock& block, std::span<const Index> faces) {
    FaceGroup& group = blocks_.groups.emplace_back();
    for (std::size_t k = 0; k < kFacesAbreast; ++k) {
      const std::size_t t = at(faces[std::min(k, faces.size() - 1)]);
      const Vec2 first = -rest_[t].edge[0], second = rest_[t].edge[2];
      const double length = first.norm(), height = 2 * rest_[t].area / length;
      for (std::size_t i = 0; i < 3; ++i) group.corner[i][k] = number(block, faces_[t][i]);
      group.across[k] = 1 / length;
      group.shear[k] = -first.dot(second) / (length * length * height);
      group.up[k] = 1 / height;
      group.area[k] = k < faces.size() ? rest_[t].area : 0;
    }
  }

  Index number(const FaceBlock& block, Index v) {
    const Index rank = rank_[at(v)];
    if (rank < block.first + block.own) return rank - block.first;
    if (number_[at(rank)] == kNone) {
      number_[at(rank)] =
          block.own + static_cast<Index>(blocks_.beyond.size() - block.beyond_begin);
      blocks_.beyond.push_back(rank);
    }
    return number_[at(rank)];
  }

  std::span<const measure::RestTriangle> rest_;
  std::span<const Triangle> faces_;
  std::span<const Index> rank_;
  std::vector<Index> number_;  ///< of each rank beyond the block being built
  FaceBlocks blocks_;
};

}  // namespace

FaceBlocks face_blocks(std::span<const measure::RestTriangle> rest, std::span<const Triangle> faces,
                       std::span<const Index> rank, const std::stop_token& stop) {
  assert(rest.size() == faces.size());
  return Builder(rest, faces, rank).build(stop);
}

}  // namespace unwrapd::solve::arap
