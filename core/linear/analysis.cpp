// Pairs of unknowns are ordered as one, since they are coupled with the same others: the order of
// their vertices, its tree and its supernodes, with each column taken twice.
#include "core/linear/analysis.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/linear/sparse.hpp"

namespace unwrapd::linear {
namespace {

/// Lists the matrix's entries by reordered columns.
void list_entries(const SparsePattern& lower, const std::stop_token& stop, Analysis& analysis) {
  const std::vector<Index>& position = analysis.nodes.position;
  const auto for_each_entry = [&](auto visit) {
    for (Index j = 0; j < lower.columns(); ++j) {
      check_cancelled_every(j, stop);
      for (Index p = lower.begin[at(j)]; p < lower.begin[at(j) + 1]; ++p)
        visit(std::minmax(position[at(j)], position[at(lower.row[at(p)])]), p);
    }
  };
  analysis.entry_begin.assign(position.size() + 1, 0);
  for_each_entry(
      [&](std::pair<Index, Index> ends, Index) { ++analysis.entry_begin[at(ends.first) + 1]; });
  std::partial_sum(analysis.entry_begin.begin(), analysis.entry_begin.end(),
                   analysis.entry_begin.begin());
  analysis.entry_row.resize(at(analysis.entry_begin.back()));
  analysis.entry_source.resize(analysis.entry_row.size());
  std::vector<Index> next(analysis.entry_begin.begin(), analysis.entry_begin.end() - 1);
  for_each_entry([&](std::pair<Index, Index> ends, Index p) {
    const std::size_t to = at(next[at(ends.first)]++);
    analysis.entry_row[to] = ends.second;
    analysis.entry_source[to] = p;
  });
}

Graph graph_of(const SparsePattern& lower, const std::stop_token& stop) {
  return graph_of_lower(lower.begin, lower.row, stop);
}

/// The pattern of a matrix of pairs, one row a pair.
Graph graph_of_pairs(const SparsePattern& lower, const std::stop_token& stop) {
  assert(lower.columns() % 2 == 0);
  std::vector<Index> begin{0}, row;
  for (Index j = 0; j < lower.columns(); j += 2) {
    for (Index p = lower.begin[at(j)]; p < lower.begin[at(j) + 1]; ++p)
      if (lower.row[at(p)] % 2 == 0) row.push_back(lower.row[at(p)] / 2);
    begin.push_back(static_cast<Index>(row.size()));
  }
  return graph_of_lower(begin, row, stop);
}

/// Replaces each number i by 2i and 2i + 1.
std::vector<Index> with_twins(std::span<const Index> numbers) {
  std::vector<Index> both;
  both.reserve(2 * numbers.size());
  for (Index i : numbers) both.insert(both.end(), {2 * i, 2 * i + 1});
  return both;
}

Supernodes duplicate_columns(Supernodes nodes) {
  nodes.order = with_twins(nodes.order);
  nodes.position = with_twins(nodes.position);
  nodes.row = with_twins(nodes.row);
  for (Index& k : nodes.first) k *= 2;
  for (std::size_t& k : nodes.row_begin) k *= 2;
  return nodes;
}

std::shared_ptr<const Analysis> complete(Supernodes nodes, const SparsePattern& lower,
                                         const std::stop_token& stop) {
  Analysis analysis;
  analysis.nodes = std::move(nodes);
  list_entries(lower, stop, analysis);
  throw_if_cancelled(stop);
  analysis.panel_begin.assign(1, 0);
  for (std::size_t s = 0; s < analysis.nodes.count(); ++s)
    analysis.panel_begin.push_back(analysis.panel_begin.back() + analysis.shape(s).size());
  analysis.pending_size = most_pending(analysis.nodes, {0, analysis.nodes.count()});
  std::vector<std::size_t> weight;
  for (std::size_t s = 0; s < analysis.nodes.count(); ++s)
    weight.push_back(analysis.shape(s).size());
  analysis.branches = branches_of(analysis.nodes, weight);
  return std::make_shared<const Analysis>(std::move(analysis));
}

}  // namespace

SparsePattern::SparsePattern(const SparseMatrix& matrix)
    : begin(matrix.outerIndexPtr(), static_cast<std::size_t>(matrix.cols()) + 1),
      row(matrix.innerIndexPtr(), static_cast<std::size_t>(matrix.nonZeros())) {
  assert(matrix.isCompressed());
}

void describe(CacheKey& key, const SparsePattern& pattern) {
  const auto& [begin, row] = pattern;
  key.add(begin).add(row);
}

/// The stack of updates: a supernode pops those of its children and pushes its own.
std::size_t most_pending(const Supernodes& nodes, Branch branch) {
  std::vector<std::size_t> pile;
  std::size_t size = 0, most = 0;
  for (std::size_t s = branch.first; s < branch.end; ++s) {
    for (Index c = 0; c < nodes.child_count[s]; ++c) size -= pile.back(), pile.pop_back();
    pile.push_back(packed_size(nodes.below(s).size()));
    size += pile.back();
    most = std::max(most, size);
  }
  return most;
}

std::size_t Analysis::bytes() const {
  const std::size_t numbers = nodes.order.size() + nodes.position.size() + nodes.first.size() +
                              nodes.child_count.size() + nodes.row.size() + entry_begin.size() +
                              entry_row.size() + entry_source.size();
  return sizeof(Index) * (numbers + branches.shared.size()) +
         sizeof(std::size_t) * (nodes.row_begin.size() + panel_begin.size());
}

std::size_t Analysis::scratch_bytes() const {
  std::size_t front = 0;
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    const std::size_t size = nodes.pivots(s) + nodes.below(s).size();
    front = std::max(front, size * (size + nodes.pivots(s)));
  }
  return 2 * sizeof(double) * (front + pending_size);  // two threads at least
}

std::shared_ptr<const Analysis> analyse(const SparsePattern& lower, const std::stop_token& stop) {
  return complete(analyse(graph_of(lower, stop), stop), lower, stop);
}

std::shared_ptr<const Analysis> analyse_in_order(const SparsePattern& lower,
                                                 const std::stop_token& stop) {
  std::vector<Index> order(static_cast<std::size_t>(lower.columns()));
  std::iota(order.begin(), order.end(), 0);
  return complete(analyse(graph_of(lower, stop), std::move(order), stop), lower, stop);
}

std::shared_ptr<const Analysis> analyse_pairs(const SparsePattern& lower,
                                              const std::stop_token& stop) {
  return complete(duplicate_columns(analyse(graph_of_pairs(lower, stop), stop)), lower, stop);
}

}  // namespace unwrapd::linear
