#pragma once
// A barrier that keeps the boundary of a map from crossing itself: vertices repel boundary edges
// that come near.

#include <array>
#include <span>
#include <vector>

#include "core/linear/pair_system.hpp"
#include "core/solve/base/disk.hpp"

namespace unwrapd::solve::repair {

/// A boundary vertex and a boundary edge without it, which repel each other when they are nearer
/// than `reach`.
struct Contact {
  Index vertex;
  std::array<Index, 2> edge;
  double reach;
  double weight;
};

/// The vertex, then the ends of the edge.
Triangle vertices_of(const Contact& contact);

/// The energy sum w (reach / d - 1)^2 over all contacts, d the distance in the map: 0 where nothing
/// is near, without bound as d goes to 0 (Smith, Schaefer 2015, Sec. 4). The reach is a quarter of
/// the shortest of the three boundary edges concerned, as in the rest triangles; the weight is the
/// area of the triangles around the vertex, so that it is of the size of their own energy.
class BoundaryBarrier {
 public:
  explicit BoundaryBarrier(const Disk& disk);

  /// The contacts nearer than `ahead` times their reach, in an order that depends on the map alone.
  /// uv: one a vertex of the disk, finite.
  [[nodiscard]] std::vector<Contact> contacts(std::span<const Vec2> uv, double ahead = 1) const;

 private:
  struct Edge {
    std::array<Index, 2> ends;
    double length;  ///< no less than a tenth of the mean
  };
  struct Corner {
    Index vertex;
    double length;  ///< of the shorter edge of the two
    double weight;
  };

  std::vector<Edge> edges_;
  std::vector<Corner> corners_;
};

double contact_energy(std::span<const Contact> contacts, std::span<const Vec2> uv);

/// Adds the gradient of the contacts to the given one.
void add_contact_gradient(std::span<const Contact> contacts, std::span<const Vec2> uv,
                          std::span<Vec2> gradient);

/// The second derivative along the distance, as a lower triangle by vertices_of(). It bounds the
/// Hessian from above, except for the curvature of the distance itself.
linear::PairElement contact_curvature(const Contact& contact, std::span<const Vec2> uv);

}  // namespace unwrapd::solve::repair
