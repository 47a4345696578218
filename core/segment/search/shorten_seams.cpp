// Borders come from clusters of triangles and zigzag; merging keeps some and drops others, and what
// is kept need no longer lie where a cluster ended. Each is replaced by a shortest path (Dijkstra)
// whose ends stay where seams meet. Where the maps do not allow it, a path nearby may do: what
// remains then lies where the distortion asks for it, without its zigzag.
#include "core/segment/search/shorten_seams.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/segment/base/ranks.hpp"
#include "core/segment/base/region_pair.hpp"
#include "core/segment/search/remap.hpp"
#include "core/segment/search/seam_paths.hpp"

namespace unwrapd::segment::search {
namespace {

constexpr double kWorthwhile = 0.995;  // of a row's length: longer paths change nothing
constexpr std::array kCorridors = {1'000'000, 4, 1};  // sides of triangles off the row
constexpr std::size_t kLeastHalved = 8, kNeverHalved = std::numeric_limits<std::size_t>::max();
constexpr int kRounds = 2;

class Shortening {
 public:
  /// least: rows of fewer sides are not shortened half by half.
  Shortening(const MergeContext& context, const MergeSettings& settings, std::size_t least,
             Partition& partition)
      : context_(context),
        surface_(context.surface),
        settings_(settings),
        least_(least),
        partition_(partition),
        corners_(linear::vertex_corners(surface_.mesh.faces, surface_.mesh.vertex_count())),
        seams_(surface_, partition) {
    for (const MappedRegion& region : partition.regions) total_ += region.excess;
  }

  void run() {
    for (const Chain& row : seams_.rows()) shorten(row);
  }

  void run_between(Index a, Index b) {
    for (const Chain& row : seams_.rows()) {
      const Index left = seams_.owner(row.front()), right = seams_.owner(twin(row.front()));
      if ((left == a && right == b) || (left == b && right == a)) shorten(row);
    }
  }

 private:
  [[nodiscard]] Index twin(Index h) const { return surface_.halfedges.twin[h]; }

  /// By the shortest path that the maps on both sides allow: nearer and nearer to the row, then
  /// half of the row by half.
  void shorten(const Chain& row) {
    throw_if_cancelled(context_.stop);
    const bool is_ring = seams_.start(row.front()) == seams_.end(row.back());
    if (row.size() < 2 || is_ring || !is_still_there(row) || shorten_whole(row)) return;
    if (row.size() < least_) return;
    const auto half = row.begin() + std::ssize(row) / 2;
    shorten({row.begin(), half});
    shorten({half, row.end()});
  }

  /// Rows found before may have moved with others since.
  [[nodiscard]] bool is_still_there(const Chain& row) const {
    const Index a = seams_.owner(row.front()), b = seams_.owner(twin(row.front()));
    const char open = partition_.open[row.front()];
    return std::ranges::all_of(row, [&](Index h) {
      const bool is_within = h == row.back() || seams_.degree(seams_.end(h)) == 2;
      return is_within && seams_.is_seam(h) && partition_.open[h] == open && seams_.owner(h) == a &&
             seams_.owner(twin(h)) == b;
    });
  }

  [[nodiscard]] double length(const Chain& row) const {
    double sum = 0;
    for (const Index h : row) sum += surface_.seam_cost[h];
    return sum;
  }

  /// Whether the row is as short as its corridors allow from now on. If not, no path was allowed.
  bool shorten_whole(const Chain& row) {
    const char was_open = partition_.open[row.front()];
    const bool is_slit = seams_.is_slit(row.front());
    set_open(row, 0);
    const SeamPaths paths(surface_, corners_, seams_, partition_.open, row);
    Chain last;
    for (const int corridor : kCorridors) {
      Chain path = paths.shortest(corridor, kWorthwhile * length(row));
      if (path.empty()) break;
      if (path == last) continue;
      if (is_slit ? move_slit(row, path) : move_border(row, path)) {
        seams_ = SeamGraph(surface_, partition_);
        return true;
      }
      last = std::move(path);
    }
    set_open(row, was_open);
    return last.empty();
  }

  void set_open(const Chain& row, char is_open) {
    for (const Index h : row) partition_.open[h] = partition_.open[twin(h)] = is_open;
  }

  bool move_border(const Chain& row, const Chain& path) {
    MappedRegion& a = partition_.regions[seams_.owner(row.front())];
    MappedRegion& b = partition_.regions[seams_.owner(twin(row.front()))];
    auto sides = part_faces(row, path);
    const std::size_t count = a.faces.size() + b.faces.size();
    if (sides[0].empty() || sides[0].size() + sides[1].size() != count) return false;
    Chain seen_from_b;
    for (const Index h : row) seen_from_b.push_back(twin(h));
    const Region both = beside(surface_, a, b, seen_from_b);
    const double most = std::max({settings_.cap, a.mean_excess(), b.mean_excess()});
    std::array<MappedRegion, 2> now;
    ExcessDistortion after = total_ - a.excess - b.excess;
    const std::size_t smaller = sides[1].size() < sides[0].size() ? 1 : 0;
    for (const std::size_t k : {smaller, 1 - smaller}) {
      now[k] = map_faces(std::move(sides[k]), both, most);
      after += now[k].excess;
      const bool fits = after.worst() <= std::max(settings_.budget, total_.worst());
      if (!now[k].is_sound || !fits) return false;
    }
    total_ = after;
    a = std::move(now[0]);
    b = std::move(now[1]);
    return true;
  }

  /// The faces of both regions parted along the path instead of the row: those on its two sides;
  /// empty where that does not make two connected sets.
  [[nodiscard]] std::array<std::vector<Index>, 2> part_faces(const Chain& row,
                                                             const Chain& path) const {
    std::vector<char> is_row(surface_.length.size(), 0), is_path(surface_.length.size(), 0);
    for (const Index h : row) is_row[h] = is_row[twin(h)] = 1;
    for (const Index h : path) is_path[h] = is_path[twin(h)] = 1;
    std::vector<char> seen(surface_.mesh.faces.size(), 0);
    const auto flood = [&](Index from) {
      std::vector<Index> faces{from};
      seen[from] = 1;
      for (std::size_t k = 0; k < faces.size(); ++k)
        for (Index h = 3 * faces[k]; h < 3 * faces[k] + 3; ++h) {
          if (twin(h) == kNoTwin || partition_.open[h] != 0 || is_path[h] != 0) continue;
          if ((seams_.owner(h) != seams_.owner(twin(h)) && is_row[h] == 0) ||
              seen[face_of(twin(h))] != 0)
            continue;
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

  /// Some of the faces of a region as one of their own, with its map. most: of its excess, for its
  /// area.
  [[nodiscard]] MappedRegion map_faces(std::vector<Index> faces, const Region& both,
                                       double most) const {
    const Ranks rank(surface_.mesh.faces.size(), both.faces);
    MappedRegion region;
    for (const Index t : faces) {
      region.uv.push_back(both.uv[rank[t]]);
      region.area += surface_.area(t);
    }
    region.faces = std::move(faces);
    const TestRules rules{
        .most_excess = most * region.area, .stop = context_.stop, .memory = context_.failures};
    const TestResult result = test_parameterization(surface_, partition_.open, rules, region);
    if (context_.progress != nullptr) context_.progress->add(region.faces.size());
    region.excess = result.excess;
    region.is_sound = result.verdict == Verdict::sound;
    return region;
  }

  /// Whether the slit, which is closed, runs along the path from now on.
  bool move_slit(const Chain& slit, const Chain& path) {
    MappedRegion& old = partition_.regions[seams_.owner(slit.front())];
    MappedRegion now = old;
    set_open(slit, 1);
    set_open(path, 1);
    static_cast<Region&>(now) = with_pockets_moved(old, slit);
    set_open(slit, 0);
    set_open(path, 1);
    if (!remap(context_, settings_, partition_.open, old.excess, now, total_)) {
      set_open(path, 0);
      return false;
    }
    old = std::move(now);
    return true;
  }

  /// Between a slit and the path that it shall take lie pockets, shut off by both. Each is laid
  /// where the other side of the slit is.
  [[nodiscard]] Region with_pockets_moved(Region region, const Chain& row) const {
    const std::vector<Index> piece = pieces(region.faces);
    std::vector<Index> size;
    for (const Index t : region.faces) {
      size.resize(std::max(size.size(), static_cast<std::size_t>(piece[t]) + 1));
      ++size[piece[t]];
    }
    const Index outside = static_cast<Index>(std::ranges::max_element(size) - size.begin());
    for (Index k = 0; k < static_cast<Index>(size.size()); ++k) {
      if (k == outside) continue;
      Region rest, pocket;
      for (std::size_t f = 0; f < region.faces.size(); ++f) {
        Region& own = piece[region.faces[f]] == k ? pocket : rest;
        own.faces.push_back(region.faces[f]);
        own.uv.push_back(region.uv[f]);
      }
      Chain border;
      for (const Index edge : row)
        for (const Index h : {edge, twin(edge)})
          if (piece[face_of(h)] == k && piece[face_of(twin(h))] != k) border.push_back(h);
      if (!border.empty()) region = beside(surface_, rest, pocket, border);
    }
    return region;
  }

  /// The piece of each face, where seams take these faces apart; others have none, -1.
  [[nodiscard]] std::vector<Index> pieces(const std::vector<Index>& faces) const {
    std::vector<Index> piece(surface_.mesh.faces.size(), -1);
    Index count = 0;
    for (const Index first : faces) {
      if (piece[first] >= 0) continue;
      std::vector<Index> reached{first};
      piece[first] = count;
      for (std::size_t k = 0; k < reached.size(); ++k)
        for (Index h = 3 * reached[k]; h < 3 * reached[k] + 3; ++h) {
          if (seams_.is_seam(h) || piece[face_of(twin(h))] >= 0) continue;
          piece[face_of(twin(h))] = count;
          reached.push_back(face_of(twin(h)));
        }
      ++count;
    }
    return piece;
  }

  const MergeContext& context_;
  const SegmentationMesh& surface_;
  const MergeSettings& settings_;
  std::size_t least_;
  Partition& partition_;
  linear::VertexCorners corners_;
  SeamGraph seams_;
  ExcessDistortion total_;
};

}  // namespace

void shorten_seams(const MergeContext& context, const MergeSettings& settings,
                   Partition& partition) {
  for (int round = 0; round < kRounds; ++round)
    Shortening(context, settings, kNeverHalved, partition).run();
}

void shorten_between(const MergeContext& context, const MergeSettings& settings, std::size_t a,
                     std::size_t b, Partition& partition) {
  for (int round = 0; round < kRounds; ++round)
    Shortening(context, settings, kNeverHalved, partition)
        .run_between(static_cast<Index>(a), static_cast<Index>(b));
}

void shorten_in_parts(const MergeContext& context, const MergeSettings& settings,
                      Partition& partition) {
  for (int round = 0; round < kRounds; ++round)
    Shortening(context, settings, kLeastHalved, partition).run();
}

}  // namespace unwrapd::segment::search
