// The shortest seam is a minimum cut of the dual graph, whose capacities are the lengths of edges.
// Dinic's algorithm (1970): all shortest ways at once, by layers, until none is left.
#include "core/charts/shortest_seam.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/charts/seam_weight.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::charts {
namespace {

constexpr double kStepsOfAnEdge = 1000;

class SeamFlow {
 public:
  SeamFlow(const Chart& chart, const std::array<std::vector<Index>, 2>& sets, std::stop_token stop)
      : twin_(chart.halfedges.twin), sets_(sets), stop_(std::move(stop)) {
    std::vector<double> length(twin_.size(), 0);
    double sum = 0;
    for (Index h = 0; h < static_cast<Index>(twin_.size()); ++h) {
      length[h] =
          seam_weight(chart.avoid, h) * (chart.mesh.positions[end_of(chart.mesh.faces, h)] -
                                         chart.mesh.positions[start_of(chart.mesh.faces, h)])
                                            .norm();
      sum += length[h];
    }
    const double unit = sum > 0 ? kStepsOfAnEdge * static_cast<double>(twin_.size()) / sum : 0;
    for (std::size_t h = 0; h < twin_.size(); ++h)
      room_.push_back(twin_[h] == kNoTwin ? 0 : 1 + std::llround(unit * length[h]));
    is_end_.assign(chart.mesh.faces.size(), 0);
    for (const Index t : sets_[1]) is_end_[t] = 1;
  }

  /// Fills the way between the sets. Then layer() tells which side of the seam a face is on.
  void fill() {
    while (find_layers()) {
      next_.assign(layer_.size(), 0);
      for (const Index t : sets_[0])
        while (push_from(t)) check_cancelled_every(pushes_++, stop_);
    }
  }

  [[nodiscard]] bool is_of_first(Index t) const { return layer_[t] >= 0; }

 private:
  /// The distance of each face from the first set through sides with room; whether the second set
  /// is within reach.
  bool find_layers() {
    throw_if_cancelled(stop_);
    layer_.assign(is_end_.size(), -1);
    std::vector<Index> reached = sets_[0];
    for (const Index t : reached) layer_[t] = 0;
    bool is_open = false;
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (Index h = 3 * reached[k]; h < 3 * reached[k] + 3; ++h) {
        if (room_[h] == 0 || layer_[face_of(twin_[h])] >= 0) continue;
        const Index to = face_of(twin_[h]);
        layer_[to] = layer_[reached[k]] + 1;
        is_open = is_open || is_end_[to] != 0;
        reached.push_back(to);
      }
    return is_open;
  }

  /// Pushes along one way from a face of the first set; false where there is none left.
  bool push_from(Index from) {
    way_.clear();
    for (Index t = from; is_end_[t] == 0;) {
      if (const Index h = open_side(t); h != kNoTwin) {
        way_.push_back(h);
        t = face_of(twin_[h]);
      } else if (way_.empty()) {
        return false;
      } else {
        t = face_of(way_.back());
        ++next_[t];  // that side leads nowhere
        way_.pop_back();
      }
    }
    std::int64_t least = room_[way_.front()];
    for (const Index h : way_) least = std::min(least, room_[h]);
    for (const Index h : way_) {
      room_[h] -= least;
      room_[twin_[h]] += least;
    }
    return true;
  }

  /// The side by which a way goes on from t, in the next layer.
  Index open_side(Index t) {
    for (; next_[t] < 3; ++next_[t]) {
      const Index h = 3 * t + next_[t];
      if (room_[h] > 0 && layer_[face_of(twin_[h])] == layer_[t] + 1) return h;
    }
    return kNoTwin;
  }

  const std::vector<Index>& twin_;
  const std::array<std::vector<Index>, 2>& sets_;
  std::stop_token stop_;
  std::vector<std::int64_t> room_;  ///< of half-edges: what may still cross from their face
  std::vector<char> is_end_;        ///< faces of the second set
  std::vector<Index> layer_, next_, way_;
  std::size_t pushes_ = 0;
};

}  // namespace

Halfedges cut_between(const Chart& chart, const std::array<std::vector<Index>, 2>& sets,
                      const std::stop_token& stop) {
  SeamFlow flow(chart, sets, stop);
  flow.fill();
  Halfedges cut = chart.halfedges;
  for (Index h = 0; h < static_cast<Index>(cut.twin.size()); ++h)
    if (cut.twin[h] != kNoTwin &&
        flow.is_of_first(face_of(h)) != flow.is_of_first(face_of(cut.twin[h])))
      cut.twin[h] = kNoTwin;
  return cut;
}

}  // namespace unwrapd::charts
