// A grid finds near pairs: an edge is entered into every cell that its box meets, and a vertex
// looks into one cell. The grid has about as many cells as there are edges, whatever their lengths.
#include "core/solve/repair/boundary_barrier.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/edges.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kReach = 0.25;       // of the shortest boundary edge concerned
constexpr double kLeastLength = 0.1;  // of the mean boundary edge: shorter ones count as this long

/// The place of a contact, and its derivative: the distance's gradient is share[i] * normal at the
/// vertex and at the two ends of the edge.
struct Gap {
  double distance;
  Vec2 normal;
  std::array<double, 3> share;
};

Gap gap_of(const Contact& contact, std::span<const Vec2> uv) {
  const Vec2 &a = uv[contact.edge[0]], &b = uv[contact.edge[1]];
  const Vec2 along = b - a, from_a = uv[contact.vertex] - a;
  const double s = std::clamp(from_a.dot(along) / along.squaredNorm(), 0.0, 1.0);
  const Vec2 across = from_a - s * along;
  const double distance = across.norm();
  return {distance, across / distance, {1, s - 1, -s}};
}

struct Entry {
  std::size_t cell, edge;
  auto operator<=>(const Entry&) const = default;
};

/// A grid of the enlarged boxes of edges.
class EdgeGrid {
 public:
  EdgeGrid(const Vec2& low, const Vec2& high, std::size_t edges)
      : low_(low), side_(static_cast<std::size_t>(std::sqrt(static_cast<double>(edges))) + 1) {
    cell_ = (high - low) / static_cast<double>(side_);
  }

  void add(std::size_t edge, const Vec2& low, const Vec2& high) {
    for (std::size_t y = place(low, 1); y <= place(high, 1); ++y)
      for (std::size_t x = place(low, 0); x <= place(high, 0); ++x)
        entries_.push_back({y * side_ + x, edge});
  }

  void sort() { std::sort(entries_.begin(), entries_.end()); }

  template <class Visit>
  void visit(const Vec2& point, Visit visit) const {
    const std::size_t cell = place(point, 1) * side_ + place(point, 0);
    auto it = std::lower_bound(entries_.begin(), entries_.end(), Entry{cell, 0});
    for (; it != entries_.end() && it->cell == cell; ++it) visit(it->edge);
  }

 private:
  [[nodiscard]] std::size_t place(const Vec2& point, int axis) const {
    const double at = (point[axis] - low_[axis]) / cell_[axis];
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(side_ - 1)));
  }

  Vec2 low_, cell_;
  std::size_t side_;
  std::vector<Entry> entries_;
};

double area_around(const Disk& disk, Index v) {
  double area = 0;
  for (Index k = disk.corners.begin[v]; k < disk.corners.begin[v + 1]; ++k)
    area += disk.rest[disk.corners.corner[k] / 3].area;
  return area;
}

}  // namespace

Triangle vertices_of(const Contact& contact) {
  return {contact.vertex, contact.edge[0], contact.edge[1]};
}

BoundaryBarrier::BoundaryBarrier(const Disk& disk) {
  double total = 0;
  for (const BoundaryLoop& loop : disk.loops)
    for (const Index h : loop) {
      const Index a = start_of(disk.faces, h), b = end_of(disk.faces, h);
      edges_.push_back({{a, b}, disk.rest[h / 3].edge[static_cast<std::size_t>(h % 3)].norm()});
      total += edges_.back().length;
    }
  for (Edge& edge : edges_)
    edge.length = std::max(edge.length, kLeastLength * total / static_cast<double>(edges_.size()));
  for (std::size_t begin = 0, k = 0; k < disk.loops.size(); begin += disk.loops[k++].size())
    for (std::size_t i = 0, n = disk.loops[k].size(); i < n; ++i) {
      const Edge &own = edges_[begin + i], &before = edges_[begin + (i + n - 1) % n];
      const Index v = own.ends[0];
      corners_.push_back({v, std::min(own.length, before.length), area_around(disk, v)});
    }
}

std::vector<Contact> BoundaryBarrier::contacts(std::span<const Vec2> uv, double ahead) const {
  Vec2 low = uv[edges_.front().ends[0]], high = low;
  for (const Corner& corner : corners_) {
    low = low.cwiseMin(uv[corner.vertex]);
    high = high.cwiseMax(uv[corner.vertex]);
  }
  EdgeGrid grid(low, high, edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Vec2 &a = uv[edges_[e].ends[0]], &b = uv[edges_[e].ends[1]];
    const Vec2 margin = Vec2::Constant(ahead * kReach * edges_[e].length);
    grid.add(e, a.cwiseMin(b) - margin, a.cwiseMax(b) + margin);
  }
  grid.sort();
  std::vector<Contact> found;
  for (const Corner& corner : corners_)
    grid.visit(uv[corner.vertex], [&](std::size_t e) {
      const Edge& edge = edges_[e];
      if (edge.ends[0] == corner.vertex || edge.ends[1] == corner.vertex) return;
      const double reach = kReach * std::min(edge.length, corner.length);
      const Contact contact{corner.vertex, edge.ends, reach, corner.weight};
      if (gap_of(contact, uv).distance < ahead * reach) found.push_back(contact);
    });
  return found;
}

double contact_energy(std::span<const Contact> contacts, std::span<const Vec2> uv) {
  double energy = 0;
  for (const Contact& contact : contacts) {
    const double excess = contact.reach / gap_of(contact, uv).distance - 1;
    if (excess > 0) energy += contact.weight * excess * excess;
  }
  return energy;
}

void add_contact_gradient(std::span<const Contact> contacts, std::span<const Vec2> uv,
                          std::span<Vec2> gradient) {
  for (const Contact& contact : contacts) {
    const Gap gap = gap_of(contact, uv);
    const double q = contact.reach / gap.distance;
    const double slope = -2 * contact.weight * std::max(0.0, q - 1) * q / gap.distance;
    for (std::size_t i = 0; i < 3; ++i)
      gradient[vertices_of(contact)[i]] += slope * gap.share[i] * gap.normal;
  }
}

linear::PairElement contact_curvature(const Contact& contact, std::span<const Vec2> uv) {
  linear::PairElement element{};
  const Gap gap = gap_of(contact, uv);
  const double q = contact.reach / gap.distance;
  if (!(q > 1)) return element;
  const double bend = 2 * contact.weight * q * (3 * q - 2) / (gap.distance * gap.distance);
  std::array<double, 6> along{};  // the gradient of the distance
  for (std::size_t i = 0; i < 3; ++i) {
    along[2 * i] = gap.share[i] * gap.normal.x();
    along[2 * i + 1] = gap.share[i] * gap.normal.y();
  }
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k <= i; ++k) element[i][k] = bend * along[i] * along[k];
  return element;
}

}  // namespace unwrapd::solve::repair
