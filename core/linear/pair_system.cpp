#include "core/linear/pair_system.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::linear {
namespace {

constexpr Index kNowhere = -1;
constexpr std::array kRaises{1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2};  // of the diagonal

/// The adjacency of slots: column s has the rows row[begin[s]] .. row[end[s] - 1], ascending.
struct SlotGraph {
  std::vector<Index> begin, end, row;
};

template <class Visit>
void for_each_side(std::span<const Triangle> faces, const FreeVertices& slots,
                   const std::stop_token& stop, Visit visit) {
  for (std::size_t h = 0; h < 3 * faces.size(); ++h) {
    check_cancelled_every(h, stop);
    const Triangle& face = faces[h / 3];
    const Index a = slots.slot[static_cast<std::size_t>(face[h % 3])];
    const Index b = slots.slot[static_cast<std::size_t>(face[(h + 1) % 3])];
    if (a != kFixed && b != kFixed && a != b)
      visit(static_cast<std::size_t>(std::min(a, b)), std::max(a, b));
  }
}

SlotGraph slot_graph(std::span<const Triangle> faces, const FreeVertices& slots,
                     const std::stop_token& stop) {
  const auto count = static_cast<std::size_t>(slots.count);
  SlotGraph graph{std::vector<Index>(count + 1, 0), {}, {}};
  for_each_side(faces, slots, stop, [&](std::size_t column, Index) { ++graph.begin[column + 1]; });
  for (std::size_t s = 0; s < count; ++s) graph.begin[s + 1] += graph.begin[s];
  graph.row.resize(static_cast<std::size_t>(graph.begin.back()));
  graph.end.assign(graph.begin.begin(), graph.begin.end() - 1);
  for_each_side(faces, slots, stop, [&](std::size_t column, Index row) {
    graph.row[static_cast<std::size_t>(graph.end[column]++)] = row;
  });
  for (std::size_t s = 0; s < count; ++s) {
    check_cancelled_every(s, stop);
    const auto first = graph.row.begin() + graph.begin[s], last = graph.row.begin() + graph.end[s];
    std::sort(first, last);
    graph.end[s] = static_cast<Index>(std::unique(first, last) - graph.row.begin());
  }
  return graph;
}

}  // namespace

SparseMatrix pair_pattern(std::span<const Triangle> faces, const FreeVertices& slots,
                          const std::stop_token& stop) {
  const SlotGraph graph = slot_graph(faces, slots, stop);
  const Index n = 2 * slots.count;
  SparseMatrix lower(n, n);
  lower.reserve(4 * static_cast<Index>(graph.row.size()) + 3 * slots.count);
  for (Index j = 0; j < n; ++j) {
    check_cancelled_every(j, stop);
    const auto s = static_cast<std::size_t>(j / 2);
    lower.startVec(j);
    for (Index i = j; i < 2 * (j / 2) + 2; ++i) lower.insertBack(i, j) = 0;
    for (auto k = static_cast<std::size_t>(graph.begin[s]);
         k < static_cast<std::size_t>(graph.end[s]); ++k) {
      lower.insertBack(2 * graph.row[k], j) = 0;
      lower.insertBack(2 * graph.row[k] + 1, j) = 0;
    }
  }
  lower.finalize();
  return lower;
}

Index entry_of(const SparseMatrix& lower, Index a, Index b) {
  const auto [column, row] = std::minmax(a, b);
  const Index* begin = lower.innerIndexPtr() + lower.outerIndexPtr()[column];
  const Index* end = lower.innerIndexPtr() + lower.outerIndexPtr()[column + 1];
  return static_cast<Index>(std::lower_bound(begin, end, row) - lower.innerIndexPtr());
}

PairSystem::PairSystem(std::span<const Triangle> faces, const FreeVertices& slots,
                       std::stop_token stop)
    : slots_(slots), stop_(std::move(stop)), lower_(pair_pattern(faces, slots, stop_)) {
  assert(slots.count > 0);
  target_.reserve(faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    check_cancelled_every(t, stop_);
    target_.push_back(targets(faces[t]));
  }
  factor_.emplace(analyse_pairs(lower_, stop_));
}

PairSystem::FaceTargets PairSystem::targets(const Triangle& face) const {
  std::array<Index, 6> row{};
  for (std::size_t k = 0; k < 6; ++k) {
    const Index slot = slots_.slot[static_cast<std::size_t>(face[k / 2])];
    row[k] = slot == kFixed ? kNowhere : 2 * slot + static_cast<Index>(k % 2);
  }
  FaceTargets targets{};
  std::size_t next = 0;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const bool is_inside = row[i] != kNowhere && row[j] != kNowhere;
      targets[next++] = {is_inside ? entry_of(lower_, row[i], row[j]) : kNowhere,
                         i != j && row[i] == row[j]};
    }
  return targets;
}

std::size_t PairSystem::bytes() const {
  const auto entries = static_cast<std::size_t>(lower_.nonZeros());
  return factor_->job_bytes() + (sizeof(double) + sizeof(Index)) * entries +
         sizeof(FaceTargets) * target_.size();
}

void PairSystem::clear() { std::fill_n(lower_.valuePtr(), lower_.nonZeros(), 0.0); }

void PairSystem::add(std::size_t t, const PairElement& element) {
  check_cancelled_every(t, stop_);
  std::size_t next = 0;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const auto [at, is_twice] = target_[t][next++];
      if (at != kNowhere) lower_.valuePtr()[at] += is_twice ? 2 * element[i][j] : element[i][j];
    }
}

void PairSystem::raise_diagonal(double share) {
  for (Index j = 0; j < static_cast<Index>(lower_.cols()); ++j)
    lower_.valuePtr()[lower_.outerIndexPtr()[j]] *= 1 + share;
}

bool PairSystem::factor() {
  SerialExecutor serial;
  JobExecutor job(serial, stop_);
  if (factor_->refill(lower_, job)) return true;
  for (double share : kRaises) {
    raise_diagonal(share);
    if (factor_->refill(lower_, job)) return true;
  }
  return false;
}

void PairSystem::solve(std::vector<Vec2>& b) const { factor_->solve_pairs(b, stop_); }

}  // namespace unwrapd::linear
