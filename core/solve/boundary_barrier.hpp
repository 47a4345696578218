#pragma once
// What keeps the boundary of a map from running into itself: vertices push away the boundary edges
// that come near.

#include <array>
#include <span>
#include <vector>

#include "core/solve/disk.hpp"

namespace unwrapd {

/// A boundary vertex and a boundary edge without it, nearer to each other than `reach`.
struct Contact {
  Index vertex;
  std::array<Index, 2> edge;
  double reach;
  double weight;
};

/// The energy sum w (reach / d - 1)^2 over all contacts, d the distance in the map: 0 where nothing
/// is near, without bound as d goes to 0 (Smith, Schaefer 2015, Sec. 4). The reach is a quarter of
/// the shortest of the three boundary edges concerned, on the surface; the weight is the area of
/// the triangles around the vertex, so that it is of the size of their own energy.
class BoundaryBarrier {
 public:
  explicit BoundaryBarrier(const Disk& disk);

  /// In an order that depends on the map alone. uv: one a vertex of the disk, finite.
  [[nodiscard]] std::vector<Contact> contacts(std::span<const Vec2> uv) const;

 private:
  struct Edge {
    std::array<Index, 2> ends;
    double length;  ///< on the surface, no less than a tenth of the mean
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

/// Adds the gradient to what is there.
void add_contact_gradient(std::span<const Contact> contacts, std::span<const Vec2> uv,
                          std::span<Vec2> gradient);

/// Adds to each vertex's block [xx, xy, yy] of a block-diagonal matrix that bounds the Hessian of
/// the contacts, their curvature along the distances, from above.
void add_contact_curvature(std::span<const Contact> contacts, std::span<const Vec2> uv,
                           std::span<Vec3> blocks);

}  // namespace unwrapd
