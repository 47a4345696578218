// Amestoy, Davis, Duff, "An approximate minimum degree ordering algorithm", 1996: the quotient
// graph, in which an eliminated vertex stands for the clique that it leaves behind; degrees bounded
// by |A_i| + |L_k \ i| + sum |L_e \ L_k| (their Eq. 4.2); vertices of equal lists merged; elements
// inside a new one dropped. Vertices with more than 10 sqrt(n) neighbours come last. This is our
// own implementation, since a library's cannot be cancelled; it takes .35 s for a million faces.
// Rejected: compacting the lists when memory runs out, which saves less than the factor takes many
// times over.
#include "core/linear/minimum_degree.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::linear {
namespace {

constexpr Index kNoNode = -1;
constexpr double kLeastDense = 16;

}  // namespace

MinimumDegree::MinimumDegree(const Graph& graph)
    : store_(graph.neighbour), left_(graph.vertex_count()) {
  const Index n = graph.vertex_count();
  nodes_.reserve(static_cast<std::size_t>(n));
  head_.assign(static_cast<std::size_t>(n), kNoNode);
  alike_.assign(static_cast<std::size_t>(n), kNoNode);
  const double dense = std::max(kLeastDense, 10 * std::sqrt(static_cast<double>(n)));
  for (Index v = 0; v < n; ++v) {
    const auto length = static_cast<Index>(graph.of(v).size());
    nodes_.push_back({.begin = graph.begin[static_cast<std::size_t>(v)],
                      .length = length,
                      .degree = length,
                      .next = kNoNode,
                      .previous = kNoNode,
                      .last = v,
                      .following = kNoNode});
    if (length > dense)
      at(v).weight = 0;
    else
      link(v, length);
  }
}

void MinimumDegree::link(Index i, Index degree) {
  Index& head = head_[static_cast<std::size_t>(degree)];
  at(i).degree = degree;
  at(i).next = head;
  at(i).previous = kNoNode;
  if (head != kNoNode) at(head).previous = i;
  head = i;
  least_ = std::min(least_, degree);
}

void MinimumDegree::unlink(Index i) {
  const Node& node = at(i);
  if (node.next != kNoNode) at(node.next).previous = node.previous;
  if (node.previous != kNoNode)
    at(node.previous).next = node.next;
  else
    head_[static_cast<std::size_t>(node.degree)] = node.next;
}

/// A vertex of least degree; kNoNode if all are eliminated.
Index MinimumDegree::pick() {
  const auto count = static_cast<Index>(head_.size());
  while (least_ < count && head_[static_cast<std::size_t>(least_)] == kNoNode) ++least_;
  return least_ < count ? head_[static_cast<std::size_t>(least_)] : kNoNode;
}

/// Merges j into i.
void MinimumDegree::join(Index i, Index j) {
  at(at(i).last).following = j;
  at(i).last = at(j).last;
  at(i).weight += std::exchange(at(j).weight, 0);
}

std::vector<Index> MinimumDegree::run(const std::stop_token& stop) {
  std::vector<Index> order, last;
  order.reserve(nodes_.size());
  for (Index v = 0; v < static_cast<Index>(nodes_.size()); ++v)
    if (at(v).weight == 0) last.push_back(v);
  left_ -= static_cast<Index>(last.size());
  std::size_t step = 0;
  for (Index k = pick(); k != kNoNode; k = pick()) {
    check_cancelled_every(step++, stop);
    eliminate(k);
    for (Index v = k; v != kNoNode; v = at(v).following) order.push_back(v);
  }
  order.insert(order.end(), last.begin(), last.end());
  return order;
}

void MinimumDegree::eliminate(Index k) {
  form_element(k);
  weigh_others(at(k));
  update_lists(k);
  largest_ = std::max(largest_, at(k).degree);
  mark_ += largest_;
  take_alike_as_one(at(k));
  close_element(k);
}

/// Collects the neighbours of k, directly or through elements, which the new element replaces.
void MinimumDegree::form_element(Index k) {
  unlink(k);
  left_ -= at(k).weight;
  at(k).weight *= -1;
  const auto begin = static_cast<Index>(store_.size());
  const Node old = at(k);
  Index degree = 0;
  for (Index p = old.begin; p < old.begin + old.elements; ++p) {
    Node& element = at(entry(p));
    collect(element.begin, element.begin + element.length, degree);
    element.stamp = 0;
  }
  collect(old.begin + old.elements, old.begin + old.length, degree);
  at(k).begin = begin;
  at(k).length = static_cast<Index>(store_.size()) - begin;
  at(k).elements = 0;
  at(k).degree = degree;
}

void MinimumDegree::collect(Index first, Index end, Index& degree) {
  for (Index p = first; p < end; ++p) {
    const Index i = entry(p);
    if (at(i).weight <= 0) continue;
    unlink(i);
    degree += at(i).weight;
    at(i).weight *= -1;
    store_.push_back(i);
  }
}

/// Stamps every element near the new one with mark_ plus the weight of its vertices outside of the
/// new one.
void MinimumDegree::weigh_others(const Node& element) {
  for (Index q = element.begin; q < element.begin + element.length; ++q) {
    const Node& node = at(entry(q));
    for (Index p = node.begin; p < node.begin + node.elements; ++p) {
      Node& other = at(entry(p));
      if (other.stamp >= mark_)
        other.stamp += node.weight;
      else if (other.stamp != 0)
        other.stamp = mark_ + other.degree + node.weight;
    }
  }
}

/// Replaces covered elements by the new one in the lists of its vertices. Vertices that it covers
/// wholly are eliminated with k; the others are sorted by sums of their lists, to find equal ones.
void MinimumDegree::update_lists(Index k) {
  for (Index q = at(k).begin; q < at(k).begin + at(k).length; ++q) {
    const Index i = entry(q);
    Node& node = at(i);
    const Index sum = update_list(k, i);
    if (sum == kNoNode) {
      left_ += node.weight;
      at(k).degree += node.weight;
      join(k, i);
      continue;
    }
    Index& bucket = alike_[static_cast<std::size_t>(sum)];
    node.next = std::exchange(bucket, i);
    node.previous = sum;
  }
}

/// Returns the list's sum modulo the number of nodes; kNoNode if only k is left.
Index MinimumDegree::update_list(Index k, Index i) {
  Node& node = at(i);
  Index write = node.begin, degree = 0;
  std::size_t sum = 0;
  const auto keep = [&](Index j) {
    entry(write++) = j;
    sum += static_cast<std::size_t>(j);
  };
  for (Index p = node.begin; p < node.begin + node.elements; ++p) {
    Node& element = at(entry(p));
    if (element.stamp > mark_) {
      degree += static_cast<Index>(element.stamp - mark_);
      keep(entry(p));
    } else {
      element.stamp = 0;
    }
  }
  const Index vertices = write;
  for (Index p = node.begin + node.elements; p < node.begin + node.length; ++p) {
    const Index j = entry(p);
    if (at(j).weight <= 0) continue;
    degree += at(j).weight;
    keep(j);
  }
  if (degree == 0) return kNoNode;
  node.degree = std::min(node.degree, degree);
  entry(write) = entry(vertices);  // at least one entry was removed, k or an element that it covers
  entry(vertices) = entry(node.begin);
  entry(node.begin) = k;
  node.elements = vertices - node.begin + 1;
  node.length = write - node.begin + 1;
  return static_cast<Index>(sum % nodes_.size());
}

void MinimumDegree::take_alike_as_one(const Node& element) {
  for (Index q = element.begin; q < element.begin + element.length; ++q) {
    if (at(entry(q)).weight == 0) continue;
    Index& bucket = alike_[static_cast<std::size_t>(at(entry(q)).previous)];
    for (Index i = std::exchange(bucket, kNoNode); i != kNoNode; i = at(i).next, ++mark_) {
      const Node& node = at(i);
      if (node.next == kNoNode) break;
      for (Index p = node.begin + 1; p < node.begin + node.length; ++p) at(entry(p)).stamp = mark_;
      for (Index before = i, j = node.next; j != kNoNode; j = at(before).next) {
        if (is_alike(node, at(j))) {
          join(i, j);
          at(before).next = at(j).next;
        } else {
          before = j;
        }
      }
    }
  }
}

/// Both lists begin with the new element.
bool MinimumDegree::is_alike(const Node& marked, const Node& other) {
  if (marked.length != other.length || marked.elements != other.elements) return false;
  for (Index p = other.begin + 1; p < other.begin + other.length; ++p)
    if (at(entry(p)).stamp != mark_) return false;
  return true;
}

/// Sorts its vertices by their new degrees, without those that were merged into another.
void MinimumDegree::close_element(Index k) {
  Node& element = at(k);
  Index write = element.begin;
  for (Index q = element.begin; q < element.begin + element.length; ++q) {
    const Index i = entry(q);
    Node& node = at(i);
    if (node.weight == 0) continue;
    node.weight *= -1;
    const Index degree = std::min(node.degree + element.degree, left_) - node.weight;
    link(i, degree);
    entry(write++) = i;
  }
  element.length = write - element.begin;
  store_.resize(static_cast<std::size_t>(write));
  if (element.length == 0) element.stamp = 0;
}

}  // namespace unwrapd::linear
