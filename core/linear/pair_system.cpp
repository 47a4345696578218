#include "core/linear/pair_system.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace unwrapd {
namespace {

constexpr Index kNowhere = -1;
constexpr std::array kRaises{1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2};  // of the diagonal

using Pattern = Eigen::SparseMatrix<char, Eigen::ColMajor, Index>;

/// The vertex graph's lower triangle, diagonal included, over slots.
Pattern slot_pattern(std::span<const Triangle> faces, const FreeVertices& slots) {
  std::vector<Eigen::Triplet<char, Index>> entries;
  entries.reserve(3 * faces.size() + static_cast<std::size_t>(slots.count));
  for (Index s = 0; s < slots.count; ++s) entries.emplace_back(s, s, 1);
  for (const Triangle& face : faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = slots.slot[static_cast<std::size_t>(face[i])];
      const Index b = slots.slot[static_cast<std::size_t>(face[(i + 1) % 3])];
      if (a != kFixed && b != kFixed) entries.emplace_back(std::max(a, b), std::min(a, b), 1);
    }
  Pattern pattern(slots.count, slots.count);
  pattern.setFromTriplets(entries.begin(), entries.end(), [](char, char) { return char(1); });
  return pattern;
}

}  // namespace

PairSystem::PairSystem(std::span<const Triangle> faces, const FreeVertices& slots,
                       std::stop_token stop)
    : slots_(slots), stop_(std::move(stop)) {
  assert(slots.count > 0);
  build_pattern(faces);
  target_.reserve(faces.size());
  for (const Triangle& face : faces) target_.push_back(targets(face));
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
      targets[next++] = {is_inside ? entry(row[i], row[j]) : kNowhere, i != j && row[i] == row[j]};
    }
  return targets;
}

void PairSystem::build_pattern(std::span<const Triangle> faces) {
  const Pattern pattern = slot_pattern(faces, slots_);
  const Index n = 2 * slots_.count;
  lower_.resize(n, n);
  lower_.reserve(4 * pattern.nonZeros());
  for (Index j = 0; j < n; ++j) {
    lower_.startVec(j);
    for (Pattern::InnerIterator it(pattern, j / 2); it; ++it)
      for (Eigen::Index i = 2 * it.row(); i < 2 * it.row() + 2; ++i)
        if (i >= j) lower_.insertBack(i, j) = 0;
  }
  lower_.finalize();
}

Index PairSystem::entry(Index a, Index b) const {
  const auto [column, row] = std::minmax(a, b);
  const Index* begin = lower_.innerIndexPtr() + lower_.outerIndexPtr()[column];
  const Index* end = lower_.innerIndexPtr() + lower_.outerIndexPtr()[column + 1];
  return static_cast<Index>(std::lower_bound(begin, end, row) - lower_.innerIndexPtr());
}

std::size_t PairSystem::bytes() const {
  const auto entries = static_cast<std::size_t>(lower_.nonZeros());
  return factor_->job_bytes() + (sizeof(double) + sizeof(Index)) * entries +
         sizeof(FaceTargets) * target_.size();
}

void PairSystem::clear() { std::fill_n(lower_.valuePtr(), lower_.nonZeros(), 0.0); }

void PairSystem::add(std::size_t t, const PairElement& element) {
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

void PairSystem::solve(std::vector<Vec2>& b) const { factor_->solve_pairs(b); }

}  // namespace unwrapd
