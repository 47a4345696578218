#pragma once
// Approximate minimum degree: whoever is coupled with the fewest is eliminated first.

#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/linear/ordering.hpp"

namespace unwrapd::linear {

/// One ordering of one graph.
class MinimumDegree {
 public:
  explicit MinimumDegree(const Graph& graph);

  /// order[k]: the vertex to eliminate k-th. Once only. Looks for the stop every few thousand
  /// eliminations: throws Error{cancelled}.
  std::vector<Index> run(const std::stop_token& stop);

 private:
  /// A vertex (or several alike, taken as one), and once eliminated an element: the clique of those
  /// that it was coupled with. The list of a vertex is elements first, then vertices; that of an
  /// element is vertices.
  struct Node {
    Index begin, length;   ///< of its list
    Index elements = 0;    ///< that the list begins with
    Index weight = 1;      ///< vertices that it is; 0: part of another; negated: in the new element
    Index degree;          ///< a bound for the weight of all coupled with it
    Index next, previous;  ///< of those with the same degree, or alike in their lists' sums
    Index last, following;   ///< of the vertices taken as one with it; the next after it among them
    std::int64_t stamp = 1;  ///< 0: an element that lies in another
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
  std::vector<Index> store_;  ///< all lists, those of new elements at its end
  std::vector<Index> head_;   ///< of the vertices of each degree
  std::vector<Index> alike_;  ///< the last seen by the sums of lists
  Index least_ = 0;           ///< no degree is below it
  Index left_;                ///< vertices not eliminated
  Index largest_ = 0;         ///< degree of an element so far
  std::int64_t mark_ = 2;     ///< stamps below it are old
};

}  // namespace unwrapd::linear
