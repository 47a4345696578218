#include "core/linear/pair_system.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace unwrapd {
namespace {

constexpr Index kNowhere = -1;
constexpr double kLeastRaise = 1e-14, kMostRaise = 0.01;  // of the diagonal

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

PairSystem::PairSystem(std::span<const Triangle> faces, const FreeVertices& slots) : slots_(slots) {
  assert(slots.count > 0);
  build_pattern(faces);
  target_.resize(faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    std::array<Index, 6> row{};
    for (std::size_t k = 0; k < 6; ++k) {
      const Index s = slots.slot[static_cast<std::size_t>(faces[t][k / 2])];
      row[k] = s == kFixed ? kNowhere : 2 * s + static_cast<Index>(k % 2);
    }
    std::size_t next = 0;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        const bool is_inside = row[i] != kNowhere && row[j] != kNowhere;
        target_[t][next++] = {
            is_inside ? entry(std::max(row[i], row[j]), std::min(row[i], row[j])) : kNowhere,
            i != j && row[i] == row[j]};
      }
  }
  llt_.analyzePattern(lower_);
}

void PairSystem::build_pattern(std::span<const Triangle> faces) {
  const Pattern pattern = slot_pattern(faces, slots_);
  lower_.resize(2 * slots_.count, 2 * slots_.count);
  lower_.reserve(4 * static_cast<Index>(pattern.nonZeros()));
  for (Index j = 0; j < 2 * slots_.count; ++j) {
    lower_.startVec(j);
    for (Pattern::InnerIterator it(pattern, j / 2); it; ++it)
      for (Index k = 0; k < 2; ++k) {
        const Index i = 2 * static_cast<Index>(it.row()) + k;
        if (i >= j) lower_.insertBack(i, j) = 0;
      }
  }
  lower_.finalize();
}

Index PairSystem::entry(Index row, Index column) const {
  const Index* begin = lower_.innerIndexPtr() + lower_.outerIndexPtr()[column];
  const Index* end = lower_.innerIndexPtr() + lower_.outerIndexPtr()[column + 1];
  return static_cast<Index>(std::lower_bound(begin, end, row) - lower_.innerIndexPtr());
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

bool PairSystem::try_factor() {
  llt_.factorize(lower_);
  return llt_.info() == Eigen::Success;
}

bool PairSystem::factor() {
  if (try_factor()) return true;
  for (double share = kLeastRaise; share <= kMostRaise; share *= 100) {
    raise_diagonal(share);
    if (try_factor()) return true;
  }
  return false;
}

void PairSystem::solve(std::vector<Vec2>& b) const {
  Eigen::Map<Eigen::VectorXd> flat(b.front().data(), static_cast<Eigen::Index>(2 * b.size()));
  flat = llt_.solve(flat).eval();
}

}  // namespace unwrapd
