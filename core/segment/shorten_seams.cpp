// Borders come from clusters of triangles and zigzag; merging keeps some and drops others, and what
// is kept need no longer lie where a cluster ended. Each is replaced by a shortest path (Dijkstra)
// whose ends stay where three borders meet.
#include "core/segment/shorten_seams.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"
#include "core/mesh/edges.hpp"
#include "core/segment/ranks.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kWorthwhile = 0.98;  // of a border's length: longer paths change nothing
constexpr int kRounds = 2;

/// Half-edges of one region that lie on its border with another, in a row.
using Chain = std::vector<Index>;

class Straightening {
 public:
  Straightening(const MergeContext& context, const MergeSettings& settings, Partition& partition)
      : context_(context),
        surface_(context.surface),
        settings_(settings),
        partition_(partition),
        corners_(linear::vertex_corners(surface_.mesh.faces, surface_.mesh.vertex_count())) {
    for (const MappedRegion& patch : partition.patches) total_ += patch.excess;
    mark();
  }

  void run() {
    const std::vector<Chain> chains = find_chains();
    for (const Chain& chain : chains) {
      throw_if_cancelled(context_.stop);
      if (is_still_there(chain)) shorten(chain);
    }
  }

 private:
  [[nodiscard]] Index twin(Index h) const { return surface_.halfedges.twin[h]; }
  [[nodiscard]] Index start(Index h) const { return start_of(surface_.mesh.faces, h); }
  [[nodiscard]] Index end(Index h) const { return end_of(surface_.mesh.faces, h); }

  /// Whether the regions on both sides of h differ.
  [[nodiscard]] bool is_border(Index h) const {
    return twin(h) != kNoTwin && owner_[face_of(h)] != owner_[face_of(twin(h))];
  }
  [[nodiscard]] bool is_seam(Index h) const {
    return twin(h) == kNoTwin || partition_.open[h] != 0 || is_border(h);
  }

  /// Finds the region of each face, and how many seams meet in each vertex.
  void mark() {
    owner_.assign(surface_.mesh.faces.size(), -1);
    for (std::size_t k = 0; k < partition_.patches.size(); ++k)
      for (const Index t : partition_.patches[k].region.faces) owner_[t] = static_cast<Index>(k);
    degree_.assign(surface_.mesh.positions.size(), 0);
    for (Index h = 0; h < static_cast<Index>(surface_.length.size()); ++h) {
      if (!is_seam(h) || (twin(h) != kNoTwin && twin(h) < h)) continue;
      ++degree_[start(h)];
      ++degree_[end(h)];
    }
  }

  /// The border half-edge that goes on from h where just two meet; kNoTwin at a junction.
  [[nodiscard]] Index next_border(Index h) const {
    if (degree_[end(h)] != 2) return kNoTwin;
    Index g = next_halfedge(h);
    while (!is_seam(g)) g = next_halfedge(twin(g));
    return is_border(g) && partition_.open[g] == 0 ? g : kNoTwin;
  }

  /// Those that begin and end at junctions, each once: from the region of lower number.
  [[nodiscard]] std::vector<Chain> find_chains() const {
    std::vector<Chain> chains;
    for (Index h = 0; h < static_cast<Index>(surface_.length.size()); ++h) {
      if (!is_border(h) || partition_.open[h] != 0 || degree_[start(h)] == 2) continue;
      if (owner_[face_of(h)] > owner_[face_of(twin(h))]) continue;
      Chain chain{h};
      for (Index g = next_border(h); g != kNoTwin; g = next_border(g)) chain.push_back(g);
      if (chain.size() > 1 && start(h) != end(chain.back())) chains.push_back(std::move(chain));
    }
    return chains;
  }

  /// Chains found before may have moved with others since.
  [[nodiscard]] bool is_still_there(const Chain& chain) const {
    const Index a = owner_[face_of(chain.front())], b = owner_[face_of(twin(chain.front()))];
    return a != b && degree_[start(chain.front())] != 2 && degree_[end(chain.back())] != 2 &&
           std::ranges::all_of(chain, [&](Index h) {
             return owner_[face_of(h)] == a && owner_[face_of(twin(h))] == b;
           });
  }

  [[nodiscard]] double length(const Chain& chain) const {
    double sum = 0;
    for (const Index h : chain) sum += surface_.seam_cost[h];
    return sum;
  }

  /// The shortest way between the ends of a chain through both of its regions, meeting no other
  /// seam; empty where there is none shorter than `most`.
  [[nodiscard]] Chain shortest_path(const Chain& chain, double most) const {
    const Index a = owner_[face_of(chain.front())], b = owner_[face_of(twin(chain.front()))];
    const Index from = start(chain.front()), to = end(chain.back());
    std::vector<double> distance(degree_.size(), most);
    std::vector<Index> via(degree_.size(), kNoTwin);
    std::vector<char> on_chain(degree_.size(), 0);
    for (const Index h : chain) on_chain[end(h)] = 1;
    const auto is_inside = [&](Index h) {
      const auto of_both = [&](Index g) {
        return owner_[face_of(g)] == a || owner_[face_of(g)] == b;
      };
      const bool open = partition_.open[h] != 0;
      return twin(h) != kNoTwin && !open && of_both(h) && of_both(twin(h)) &&
             (degree_[end(h)] == 0 || on_chain[end(h)] != 0);
    };
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    distance[from] = 0;
    open.emplace(0.0, from);
    while (!open.empty() && open.top().second != to) {
      const auto [d, v] = open.top();
      open.pop();
      if (d > distance[v]) continue;
      for (Index k = corners_.begin[v]; k < corners_.begin[v + 1]; ++k) {
        const Index h = corners_.corner[k];
        if (!is_inside(h) || !(d + surface_.seam_cost[h] < distance[end(h)])) continue;
        distance[end(h)] = d + surface_.seam_cost[h];
        via[end(h)] = h;
        open.emplace(distance[end(h)], end(h));
      }
    }
    Chain path;
    for (Index v = to; v != from && via[v] != kNoTwin; v = start(path.back()))
      path.push_back(via[v]);
    return path;
  }

  /// The faces of both regions parted along the path instead of the chain: those on its two sides;
  /// empty where that does not make two connected sets.
  [[nodiscard]] std::array<std::vector<Index>, 2> parted(const Chain& chain,
                                                         const Chain& path) const {
    std::vector<char> is_chain(surface_.length.size(), 0), is_path(surface_.length.size(), 0);
    for (const Index h : chain) is_chain[h] = is_chain[twin(h)] = 1;
    for (const Index h : path) is_path[h] = is_path[twin(h)] = 1;
    std::vector<char> seen(owner_.size(), 0);
    const auto flood = [&](Index from) {
      std::vector<Index> faces{from};
      seen[from] = 1;
      for (std::size_t k = 0; k < faces.size(); ++k)
        for (Index h = 3 * faces[k]; h < 3 * faces[k] + 3; ++h) {
          if (twin(h) == kNoTwin || partition_.open[h] != 0 || is_path[h] != 0) continue;
          if ((is_border(h) && is_chain[h] == 0) || seen[face_of(twin(h))] != 0) continue;
          seen[face_of(twin(h))] = 1;
          faces.push_back(face_of(twin(h)));
        }
      std::sort(faces.begin(), faces.end());
      return faces;
    };
    std::vector<Index> left = flood(face_of(path.front()));
    if (seen[face_of(twin(path.front()))] != 0) return {};
    std::vector<Index> right = flood(face_of(twin(path.front())));
    return {std::move(left), std::move(right)};
  }

  void shorten(const Chain& chain) {
    const Chain path = shortest_path(chain, kWorthwhile * length(chain));
    if (path.empty()) return;
    const Index a = owner_[face_of(chain.front())], b = owner_[face_of(twin(chain.front()))];
    MappedRegion &old_a = partition_.patches[a], &old_b = partition_.patches[b];
    auto sides = parted(chain, path);
    const std::size_t count = old_a.region.faces.size() + old_b.region.faces.size();
    if (sides[0].empty() || sides[0].size() + sides[1].size() != count) return;
    Chain seen_from_b;
    for (const Index h : chain) seen_from_b.push_back(twin(h));
    const Region both = beside(surface_, old_a.region, old_b.region, seen_from_b);
    const double most = (old_a.excess + old_b.excess).worst();
    MappedRegion new_a = mapped(std::move(sides[0]), both, most);
    MappedRegion new_b = mapped(std::move(sides[1]), both, most);
    const ExcessDistortion after =
        total_ + new_a.excess + new_b.excess - old_a.excess - old_b.excess;
    const bool fits = after.worst() <= std::max(settings_.budget, total_.worst());
    if (!new_a.is_sound || !new_b.is_sound || !fits) return;
    total_ = after;
    old_a = std::move(new_a);
    old_b = std::move(new_b);
    mark();
  }

  /// A patch of some of the faces of a region, from its map. most: excess it may have at any rate.
  [[nodiscard]] MappedRegion mapped(std::vector<Index> faces, const Region& both,
                                    double most) const {
    const Ranks rank(owner_.size(), both.faces);
    MappedRegion patch;
    for (const Index t : faces) {
      patch.region.uv.push_back(both.uv[rank[t]]);
      patch.area += surface_.area(t);
    }
    patch.region.faces = std::move(faces);
    const TestRules rules{.most_excess = std::max(settings_.cap * patch.area, most),
                          .stop = context_.stop,
                          .memory = context_.failures};
    const TestResult result = test_parameterization(surface_, partition_.open, rules, patch.region);
    if (context_.progress != nullptr) context_.progress->add(patch.region.faces.size());
    patch.excess = result.excess;
    patch.is_sound = result.verdict == Verdict::sound;
    return patch;
  }

  const MergeContext& context_;
  const SegmentationMesh& surface_;
  const MergeSettings& settings_;
  Partition& partition_;
  linear::VertexCorners corners_;
  std::vector<Index> owner_;  ///< one a face
  std::vector<int> degree_;   ///< seams that meet in a vertex
  ExcessDistortion total_;
};

}  // namespace

void shorten_seams(const MergeContext& context, const MergeSettings& settings,
                   Partition& partition) {
  for (int round = 0; round < kRounds; ++round) Straightening(context, settings, partition).run();
}

}  // namespace unwrapd::segment
