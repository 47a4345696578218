#include "core/segment/search/seam_paths.hpp"

#include <functional>
#include <queue>
#include <utility>

namespace unwrapd::segment::search {

SeamPaths::SeamPaths(const SegmentationMesh& surface, const linear::VertexCorners& corners,
                     const SeamGraph& seams, const std::vector<char>& open, const Chain& row)
    : surface_(surface),
      corners_(corners),
      seams_(seams),
      open_(open),
      from_(seams.start(row.front())),
      to_(seams.end(row.back())),
      off_(surface.mesh.positions.size(), -1) {
  const Index a = seams.owner(row.front()), b = seams.owner(seams.twin(row.front()));
  const auto is_inside = [&](Index h) { return seams.owner(h) == a || seams.owner(h) == b; };
  std::vector<Index> reached{from_};
  for (const Index h : row) reached.push_back(seams.end(h));
  for (const Index v : reached) off_[v] = 0;
  for (std::size_t k = 0; k < reached.size(); ++k)
    for_each_side(reached[k], [&](Index h) {
      const Index v = seams.end(h);
      if (!is_inside(h) || !is_inside(seams.twin(h)) || seams.degree(v) != 0 || off_[v] >= 0)
        return;
      off_[v] = off_[reached[k]] + 1;
      reached.push_back(v);
    });
}

/// Calls visit(h) for the half-edges from v along which no seam runs but the row.
template <class Visit>
void SeamPaths::for_each_side(Index v, Visit visit) const {
  for (Index k = corners_.begin[v]; k < corners_.begin[v + 1]; ++k) {
    const Index h = corners_.corner[k];
    if (seams_.twin(h) != kNoTwin && open_[h] == 0) visit(h);
  }
}

Chain SeamPaths::shortest(int corridor, double most) const {
  std::vector<double> distance(off_.size(), most);
  std::vector<Index> via(off_.size(), kNoTwin);
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  distance[from_] = 0;
  front.emplace(0.0, from_);
  while (!front.empty() && front.top().second != to_) {
    const auto [here, v] = front.top();
    front.pop();
    if (here > distance[v]) continue;
    for_each_side(v, [&, here = here](Index h) {
      const Index w = seams_.end(h);
      const double length = here + surface_.seam_cost[h];
      if (off_[w] < 0 || off_[w] > corridor || !(length < distance[w])) return;
      distance[w] = length;
      via[w] = h;
      front.emplace(length, w);
    });
  }
  Chain path;
  for (Index v = to_; v != from_ && via[v] != kNoTwin; v = seams_.start(path.back()))
    path.push_back(via[v]);
  return path;
}

}  // namespace unwrapd::segment::search
