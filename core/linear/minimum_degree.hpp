#pragma once
// Approximate minimum degree: eliminates a vertex with the fewest neighbours first.

#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/linear/ordering.hpp"

namespace unwrapd::linear {

/// One ordering of one graph.
class MinimumDegree {
 public:
  explicit MinimumDegree(const Graph& graph);

  /// order[k]: the vertex to eliminate k-th. May be called once. Checks the stop every few thousand
  /// eliminations: throws Error{cancelled}.
  std::vector<Index> run(const std::stop_token& stop);

 private:
  /// A vertex (or several merged ones), and after its elimination an element: the clique of its
  /// neighbours. The list of a vertex has elements first, then vertices; that of an element has
  /// vertices.
  struct Node {
    Index begin, length;  ///< of its list
    Index elements = 0;   ///< at the start of the list
    Index weight = 1;  ///< number of vertices; 0: merged into another; negative: in the new element
    Index degree;      ///< bound of the weight of all neighbours
    Index next, previous;    ///< of those with the same degree, or with the same sum of lists
    Index last, following;   ///< of the vertices merged into it; the next after it among them
    std::int64_t stamp = 1;  ///< 0: an element inside another
  };

  Node& at(Index i) { return nodes_[static_cast<std::size_t>(i)]; }
  Index& entry(Index p) { return store_[static_cast<std::size_t>(p)]; }

  void link(Index i, Index degree);
  void unlink(Index i);
  Index pick();
  void join(Index i, Index j);

  void eliminate(Index k);
  void form_element(Index k);
  void collect(Index first, Index end, Index& degree);
  void weigh_others(const Node& element);
  void update_lists(Index k);
  Index update_list(Index k, Index i);
  void take_alike_as_one(const Node& element);
  bool is_alike(const Node& marked, const Node& other);
  void close_element(Index k);

  std::vector<Node> nodes_;
  std::vector<Index> store_;  ///< all lists; those of new elements at the end
  std::vector<Index> head_;   ///< of the vertices of each degree
  std::vector<Index> alike_;  ///< the last node seen for each sum of lists
  Index least_ = 0;           ///< lower bound of all degrees
  Index left_;                ///< vertices that are not eliminated yet
  Index largest_ = 0;         ///< greatest degree of an element so far
  std::int64_t mark_ = 2;     ///< smaller stamps are old
};

}  // namespace unwrapd::linear
