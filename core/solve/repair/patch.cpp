// A breadth-first walk frees the vertices near the faces. Free vertices that share a face belong to
// one patch, so that no face is in two patches.
#include "core/solve/repair/patch.hpp"

#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/base/shared_cache.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kMost = 0.5;  // of the vertices; beyond it, all are free

/// 1 for the vertices within `rings` rings of the faces.
std::vector<char> near_vertices(const Disk& disk, std::span<const Index> faces, int rings) {
  std::vector<char> near(disk.positions.size(), 0);
  std::vector<Index> front;
  const auto reach = [&](Index t) {
    for (Index v : disk.faces[t])
      if (near[v] == 0) near[v] = 1, front.push_back(v);
  };
  for (Index t : faces) reach(t);
  std::size_t first = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (const std::size_t last = front.size(); first < last; ++first) {
      check_cancelled_every(first, disk.stop);
      for (Index c = disk.corners.begin[front[first]]; c < disk.corners.begin[front[first] + 1];
           ++c)
        reach(disk.corners.corner[c] / 3);
    }
  if (static_cast<double>(front.size()) > kMost * static_cast<double>(near.size()))
    std::fill(near.begin(), near.end(), 1);
  return near;
}

class Cutter {
 public:
  Cutter(const Disk& disk, std::vector<char> loose)
      : disk_(disk),
        loose_(std::move(loose)),
        taken_(disk.faces.size(), 0),
        number_(disk.positions.size(), linear::kFixed) {}

  /// All patches of free vertices, ordered by their lowest vertex.
  std::vector<Patch> cut() {
    std::vector<Patch> patches;
    std::vector<char> open = loose_;
    for (std::size_t v = 0; v < open.size(); ++v)
      if (open[v] != 0) patches.push_back(patch_of(faces_from(static_cast<Index>(v), open)));
    return patches;
  }

 private:
  /// The faces at the free vertices connected with `seed`; marks these vertices as visited.
  std::vector<Index> faces_from(Index seed, std::vector<char>& open) {
    std::vector<Index> faces, inside{seed};
    open[seed] = 0;
    for (std::size_t k = 0; k < inside.size(); ++k) {
      check_cancelled_every(k, disk_.stop);
      for (Index c = disk_.corners.begin[inside[k]]; c < disk_.corners.begin[inside[k] + 1]; ++c) {
        const Index t = disk_.corners.corner[c] / 3;
        if (taken_[t] != 0) continue;
        taken_[t] = 1;
        faces.push_back(t);
        for (Index v : disk_.faces[t])
          if (open[v] != 0) open[v] = 0, inside.push_back(v);
      }
    }
    std::sort(faces.begin(), faces.end());
    return faces;
  }

  Patch patch_of(std::vector<Index> faces) {
    Patch patch{.mesh = {}, .face = std::move(faces), .vertex = {}};
    std::vector<char> hard;
    for (Index t : patch.face) {
      check_cancelled_every(patch.mesh.rest.size(), disk_.stop);
      patch.mesh.rest.push_back(disk_.rest[t]);
      Triangle& corners = patch.mesh.faces.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        Index& number = number_[disk_.faces[t][i]];
        if (number == linear::kFixed) {
          number = static_cast<Index>(patch.vertex.size());
          patch.vertex.push_back(disk_.faces[t][i]);
          hard.push_back(loose_[disk_.faces[t][i]] == 0 ? 1 : 0);
        }
        corners[i] = number;
      }
    }
    for (Index v : patch.vertex) number_[v] = linear::kFixed;
    patch.mesh.free = linear::number_free(hard);
    patch.mesh.stop = disk_.stop;
    if (disk_.core != nullptr)
      patch.mesh.memory = {kJobBytesPerFace * disk_.faces.size(), disk_.core->memory_limit()};
    return patch;
  }

  const Disk& disk_;
  std::vector<char> loose_;
  std::vector<char> taken_;
  std::vector<Index> number_;
};

}  // namespace

UvMap map_of(const Patch& patch, std::span<const Vec2> uv) {
  UvMap own;
  own.reserve(patch.vertex.size());
  for (Index v : patch.vertex) own.push_back(uv[v]);
  return own;
}

void put_back(const Patch& patch, std::span<const Vec2> own, UvMap& uv) {
  for (std::size_t v = 0; v < own.size(); ++v) uv[patch.vertex[v]] = own[v];
}

std::vector<Patch> patches_around(const Disk& disk, std::span<const Index> faces, int rings,
                                  std::span<const char> constrained) {
  std::vector<char> loose = near_vertices(disk, faces, rings);
  for (std::size_t v = 0; v < constrained.size(); ++v)
    if (constrained[v] != 0) loose[v] = 0;
  return Cutter(disk, std::move(loose)).cut();
}

}  // namespace unwrapd::solve::repair
