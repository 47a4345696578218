// A queue of neighbours, the union that promises most first: much border gone, little distortion
// added. A promise is what the two parts were worth when they were last tried; a union is tried
// when it comes to the top (lazy greedy, Minoux 1978), some at a time so that threads have work,
// always the same ones. Merging by normals alone stops far too early: what counts is whether ARAP
// can lay the union flat, and only ARAP knows.
#include "core/atlas/merge.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <queue>
#include <utility>

#include "core/atlas/labels.hpp"
#include "core/cancel.hpp"

namespace unwrapd {
namespace {

constexpr std::size_t kBatch = 4;       // unions tried at once
constexpr double kDistortionPrice = 5;  // of the whole budget, in borders of a whole patch
constexpr double kWideShare = 0.2;      // what the wider patch's share of border counts
constexpr double kLast = 1e99;          // the key of unions that failed before

/// What is known of a pair of neighbours.
struct Promise {
  double rise = 0;  ///< excess that their union is thought to add
  bool was_flawed = false;
  bool is_impossible = false;
};

struct Union {
  double key = 0;
  Index a = 0, b = 0;
  std::shared_ptr<Patch> tried = {};  ///< nothing: not yet

  bool operator>(const Union& other) const {
    return std::tie(key, a, b) > std::tie(other.key, other.a, other.b);
  }
};

/// One way to lay b beside a: turned and moved as their common border asks (least squares).
struct Motion {
  double cosine = 1, sine = 0;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();

  [[nodiscard]] Vec2 operator()(const Vec2& u) const {
    const Vec2 x = u - from;
    return to + Vec2(cosine * x.x() - sine * x.y(), sine * x.x() + cosine * x.y());
  }
};

Motion motion_between(std::span<const std::array<Vec2, 2>> pairs) {
  Motion motion;
  for (const auto& [b, a] : pairs) {
    motion.from += b / static_cast<double>(pairs.size());
    motion.to += a / static_cast<double>(pairs.size());
  }
  double c = 0, s = 0;
  for (const auto& [b, a] : pairs) {
    const Vec2 x = b - motion.from, y = a - motion.to;
    c += x.dot(y);
    s += x.x() * y.y() - x.y() * y.x();
  }
  const double norm = std::hypot(c, s);
  if (norm > 0) motion.cosine = c / norm, motion.sine = s / norm;
  return motion;
}

class Merging {
 public:
  Merging(const Sheet& sheet, std::span<const char> open, std::vector<Patch> patches,
          const MergeRules& rules)
      : sheet_(sheet), open_(open), rules_(rules), patches_(std::move(patches)) {
    alive_.assign(patches_.size(), 1);
    count_ = first_count_ = patches_.size();
    for (const Patch& patch : patches_) total_ += patch.excess;
    measure_borders();
  }

  void run(Executor& executor) {
    for (Index a = 0; a < static_cast<Index>(patches_.size()); ++a)
      for (const auto& [b, unused] : borders_[a])
        if (a < b) propose(a, b, {});
    while (!queue_.empty() && count_ > static_cast<std::size_t>(rules_.enough)) {
      throw_if_cancelled(rules_.stop);
      Union best = queue_.top();
      if (best.tried == nullptr) {
        try_batch(executor);
        continue;
      }
      queue_.pop();
      if (is_alive(best)) accept(best);
    }
  }

  [[nodiscard]] std::vector<Patch> take() {
    std::vector<Patch> left;
    for (std::size_t k = 0; k < patches_.size(); ++k)
      if (alive_[k] != 0) left.push_back(std::move(patches_[k]));
    return left;
  }

 private:
  void measure_borders() {
    std::vector<Index> owner(sheet_.mesh.faces.size(), -1);
    for (std::size_t k = 0; k < patches_.size(); ++k)
      for (const Index t : patches_[k].region.faces) owner[t] = static_cast<Index>(k);
    borders_.resize(patches_.size());
    perimeter_.assign(patches_.size(), 0);
    for (Index h = 0; h < static_cast<Index>(sheet_.halfedges.twin.size()); ++h) {
      const Index twin = sheet_.halfedges.twin[h], own = owner[face_of(h)];
      const Index other = twin == kNoTwin ? -1 : owner[face_of(twin)];
      if (own < 0 || own == other) continue;
      perimeter_[own] += sheet_.length[h];
      if (other >= 0 && is_glued(h)) borders_[own][other] += sheet_.length[h];
    }
  }

  [[nodiscard]] bool is_glued(Index h) const { return open_.empty() || open_[h] == 0; }
  [[nodiscard]] bool is_alive(const Union& u) const { return alive_[u.a] != 0 && alive_[u.b] != 0; }

  /// Lower is better.
  [[nodiscard]] double key(Index a, Index b, double rise) const {
    const double border = borders_[a].at(b);
    const double narrow = std::min(perimeter_[a], perimeter_[b]);
    const double wide = std::max(perimeter_[a], perimeter_[b]);
    const double price = rules_.budget > 0 ? kDistortionPrice * rise / rules_.budget : 0;
    return rounded(price - border / narrow - kWideShare * border / wide);
  }

  void propose(Index a, Index b, const Promise& promise) {
    if (promise.is_impossible || !patches_[a].is_sound || !patches_[b].is_sound) return;
    const double promised = promise.was_flawed ? kLast : key(a, b, promise.rise);
    queue_.push({promised, std::min(a, b), std::max(a, b)});
  }

  /// Tries the best unions that were not tried yet.
  void try_batch(Executor& executor) {
    std::vector<Union> batch;
    while (!queue_.empty() && batch.size() < kBatch && queue_.top().tried == nullptr) {
      if (is_alive(queue_.top())) batch.push_back(queue_.top());
      queue_.pop();
    }
    std::vector<TrialResult> results(batch.size());
    executor.for_each_block(static_cast<int>(batch.size()), [&](int k) {
      Union& own = batch[static_cast<std::size_t>(k)];
      own.tried = std::make_shared<Patch>();
      results[static_cast<std::size_t>(k)] = attempt(own, *own.tried);
    });
    throw_if_cancelled(rules_.stop);
    for (std::size_t k = 0; k < batch.size(); ++k) judge(std::move(batch[k]), results[k]);
  }

  /// The corners where b lies against a, each in both maps.
  [[nodiscard]] std::vector<std::array<Vec2, 2>> common_border(const Region& a,
                                                               const Region& b) const {
    std::vector<Index> rank(sheet_.mesh.faces.size(), -1);
    for (std::size_t k = 0; k < a.faces.size(); ++k) rank[a.faces[k]] = static_cast<Index>(k);
    std::vector<std::array<Vec2, 2>> pairs;
    for (std::size_t k = 0; k < b.faces.size(); ++k)
      for (Index i = 0; i < 3; ++i) {
        const Index h = 3 * b.faces[k] + i, twin = sheet_.halfedges.twin[h];
        if (twin == kNoTwin || rank[face_of(twin)] < 0 || !is_glued(h)) continue;
        const CornerUv& across = a.uv[rank[face_of(twin)]];
        pairs.push_back({b.uv[k][i], across[next_halfedge(twin) % 3]});
        pairs.push_back({b.uv[k][(i + 1) % 3], across[twin % 3]});
      }
    return pairs;
  }

  [[nodiscard]] TrialResult attempt(const Union& both, Patch& joined) const {
    const Patch &a = patches_[both.a], &b = patches_[both.b];
    const Motion beside = motion_between(common_border(a.region, b.region));
    joined.region = a.region;
    joined.area = a.area + b.area;
    for (std::size_t k = 0; k < b.region.faces.size(); ++k) {
      const auto& [p, q, r] = b.region.uv[k];
      joined.region.faces.push_back(b.region.faces[k]);
      joined.region.uv.push_back({beside(p), beside(q), beside(r)});
    }
    const double before = (a.excess + b.excess).worst();
    const TrialRules rules{.most_excess = std::max(rules_.cap * joined.area, before),
                           .stop = rules_.stop};
    return try_map(sheet_, open_, rules, joined.region);
  }

  void judge(Union both, const TrialResult& result) {
    Promise& known = known_[{both.a, both.b}];
    const Excess rise = result.excess - patches_[both.a].excess - patches_[both.b].excess;
    known = {std::max(rise.worst(), 0.0), result.verdict != Verdict::sound,
             result.verdict == Verdict::impossible};
    if (result.verdict != Verdict::sound) return;
    both.tried->excess = result.excess;
    both.tried->is_sound = true;
    both.key = key(both.a, both.b, known.rise);
    queue_.push(std::move(both));
  }

  void accept(const Union& best) {
    const Excess after =
        total_ + best.tried->excess - patches_[best.a].excess - patches_[best.b].excess;
    if (after.worst() > std::max(rules_.budget, total_.worst())) return;
    total_ = after;
    const auto joined = static_cast<Index>(patches_.size());
    perimeter_.push_back(perimeter_[best.a] + perimeter_[best.b] - 2 * borders_[best.a].at(best.b));
    patches_.push_back(std::move(*best.tried));
    alive_.push_back(1);
    borders_.push_back(joined_borders(best.a, best.b));
    for (const Index part : {best.a, best.b}) {
      alive_[part] = 0;
      patches_[part] = {};
    }
    --count_;
    for (const auto& [other, length] : borders_[joined]) meet(joined, other, length, best);
    if (rules_.on_progress)
      rules_.on_progress(1 - static_cast<double>(count_) / static_cast<double>(first_count_));
  }

  [[nodiscard]] std::map<Index, double> joined_borders(Index a, Index b) const {
    std::map<Index, double> borders;
    for (const Index part : {a, b})
      for (const auto& [other, length] : borders_[part])
        if (other != a && other != b) borders[other] += length;
    return borders;
  }

  /// other has a new neighbour, of which it knows what it knew of the parts.
  void meet(Index joined, Index other, double length, const Union& parts) {
    Promise promise;
    for (const Index part : {parts.a, parts.b}) {
      borders_[other].erase(part);
      const auto known = known_.find(std::minmax(part, other));
      if (known == known_.end()) continue;
      promise.rise = std::max(promise.rise, known->second.rise);
      promise.was_flawed = promise.was_flawed || known->second.was_flawed;
      promise.is_impossible = promise.is_impossible || known->second.is_impossible;
    }
    borders_[other][joined] = length;
    known_[std::minmax(joined, other)] = promise;
    propose(joined, other, promise);
  }

  const Sheet& sheet_;
  std::span<const char> open_;
  const MergeRules& rules_;
  std::vector<Patch> patches_;  ///< those that were merged are dead and empty
  std::vector<char> alive_;
  std::vector<std::map<Index, double>> borders_;  ///< lengths to each neighbour
  std::vector<double> perimeter_;
  std::map<std::pair<Index, Index>, Promise> known_;
  std::priority_queue<Union, std::vector<Union>, std::greater<>> queue_;
  Excess total_;
  std::size_t count_ = 0, first_count_ = 0;
};

}  // namespace

std::vector<Patch> merge_patches(const Sheet& sheet, std::span<const char> open,
                                 std::vector<Patch> patches, const MergeRules& rules,
                                 Executor& executor) {
  Merging merging(sheet, open, std::move(patches), rules);
  merging.run(executor);
  return merging.take();
}

}  // namespace unwrapd
