// Let w(p) be how often the boundary winds around p: how many sheets lie there. Where the boundary
// is crossed from outside, over k other sheets, g = w (w - 1) / 2 rises by k. By the divergence
// theorem the integral of g is half the sum of k x.n over the boundary, and its gradient is a
// pressure k along n: sheets shrink from each other where they overlap, however deep that is, and
// no side must know which other one it has to pass.
#include "core/solve/repair/overlap_area.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/cross.hpp"
#include "core/mesh/edges.hpp"

namespace unwrapd::solve::repair {
namespace {

/// Of a side from its start to its end, as long as it is: to the right lies the outside.
Vec2 outwards(const Vec2& along) { return {along.y(), -along.x()}; }

}  // namespace

OverlapArea::OverlapArea(const Disk& disk, std::span<const Index> rank, double gap) : gap_(gap) {
  for (const BoundaryLoop& loop : disk.loops) {
    const std::size_t first = vertex_.size();
    for (std::size_t k = 0; k < loop.size(); ++k) {
      vertex_.push_back(rank[static_cast<std::size_t>(start_of(disk.faces, loop[k]))]);
      side_.push_back({first + k, first + (k + 1) % loop.size()});
      before_.push_back(first + (k + loop.size() - 1) % loop.size());
    }
  }
  corner_.resize(vertex_.size());
}

void OverlapArea::place_corners(std::span<const Vec2> uv) {
  const auto at = [&](std::size_t corner) { return uv[static_cast<std::size_t>(vertex_[corner])]; };
  for (std::size_t k = 0; k < vertex_.size(); ++k) {
    const Vec2 one = outwards(at(k) - at(before_[k])), other = outwards(at(side_[k].to) - at(k));
    const Vec2 out = one.normalized() + other.normalized();
    const double length = out.norm();
    corner_[k] = at(k) + (length > 0 ? Vec2(gap_ / length * out) : Vec2::Zero());
  }
}

std::size_t OverlapArea::row_of(double y) const {
  return static_cast<std::size_t>(
      std::clamp((y - low_) * rows_per_unit_, 0.0, static_cast<double>(begin_.size() - 2)));
}

void OverlapArea::sort_sides() {
  low_ = corner_.front().y();
  double high = low_;
  for (const Vec2& p : corner_) low_ = std::min(low_, p.y()), high = std::max(high, p.y());
  const std::size_t rows = std::max<std::size_t>(1, side_.size() / 2);
  rows_per_unit_ = high > low_ ? static_cast<double>(rows) / (high - low_) : 0;
  begin_.assign(rows + 1, 0);
  const auto for_each_row = [&](auto visit) {
    for (std::size_t s = 0; s < side_.size(); ++s) {
      const auto [low, high_y] = std::minmax(corner_[side_[s].from].y(), corner_[side_[s].to].y());
      for (std::size_t row = row_of(low), last = row_of(high_y); row <= last; ++row) visit(row, s);
    }
  };
  for_each_row([&](std::size_t row, std::size_t) { ++begin_[row + 1]; });
  for (std::size_t row = 0; row < rows; ++row) begin_[row + 1] += begin_[row];
  in_row_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for_each_row([&](std::size_t row, std::size_t s) { in_row_[next[row]++] = s; });
}

Vec2 OverlapArea::point(std::size_t side, double at) const {
  return corner_[side_[side].from] + at * (corner_[side_[side].to] - corner_[side_[side].from]);
}

/// Where other sides cross this one, ascending.
void OverlapArea::find_crossings(std::size_t side) {
  const auto [from, to] = side_[side];
  const Vec2 &a = corner_[from], &b = corner_[to];
  const Vec2 along = b - a, low = a.cwiseMin(b), high = a.cwiseMax(b);
  crossing_.assign({0, 1});
  for (std::size_t row = row_of(low.y()), last = row_of(high.y()); row <= last; ++row)
    for (std::size_t k = begin_[row]; k < begin_[row + 1]; ++k) {
      const Side& other = side_[in_row_[k]];
      if (other.from == from || other.from == to || other.to == from) continue;
      const Vec2 &c = corner_[other.from], &d = corner_[other.to];
      if ((c.cwiseMin(d).array() > high.array()).any() ||
          (c.cwiseMax(d).array() < low.array()).any())
        continue;
      const double from_c = cross(along, c - a), from_d = cross(along, d - a);
      if ((from_c > 0) == (from_d > 0)) continue;
      const Vec2 across = d - c;
      const double turn = cross(along, across);
      if (turn == 0) continue;
      const double at = cross(c - a, across) / turn;
      if (at > 0 && at < 1) crossing_.push_back(at);
    }
  std::sort(crossing_.begin(), crossing_.end());
  crossing_.erase(std::unique(crossing_.begin(), crossing_.end()), crossing_.end());
}

/// How many sheets lie beside a point of a side, on its outside.
int OverlapArea::sheets_beyond(std::size_t side, double at) const {
  const Vec2 p = point(side, at), along = corner_[side_[side].to] - corner_[side_[side].from];
  int sheets = along.y() < 0 || (along.y() == 0 && along.x() > 0) ? -1 : 0;
  const std::size_t row = row_of(p.y());
  for (std::size_t k = begin_[row]; k < begin_[row + 1]; ++k) {
    if (in_row_[k] == side) continue;
    const Vec2 &c = corner_[side_[in_row_[k]].from], &d = corner_[side_[in_row_[k]].to];
    const bool is_above_c = c.y() <= p.y(), is_above_d = d.y() <= p.y();
    if (is_above_c == is_above_d) continue;
    const double turn = cross(d - c, p - c);
    if (is_above_c && turn > 0) ++sheets;   // upwards, p on its left
    if (!is_above_c && turn < 0) --sheets;  // downwards, p on its right
  }
  return sheets;
}

double OverlapArea::evaluate(std::span<const Vec2> uv, double weight, std::span<Vec2> force) {
  place_corners(uv);
  sort_sides();
  double area = 0;
  for (std::size_t s = 0; s < side_.size(); ++s) {
    find_crossings(s);
    const Vec2 out = outwards(corner_[side_[s].to] - corner_[side_[s].from]);
    for (std::size_t k = 0; k + 1 < crossing_.size(); ++k) {
      const double a = crossing_[k], b = crossing_[k + 1];
      const int sheets = b > a ? sheets_beyond(s, (a + b) / 2) : 0;
      if (sheets == 0) continue;
      area += 0.5 * sheets * (b - a) * out.dot(point(s, (a + b) / 2) - corner_.front());
      const double at_end = (b * b - a * a) / 2;
      force[static_cast<std::size_t>(vertex_[side_[s].from])] -=
          weight * sheets * (b - a - at_end) * out;
      force[static_cast<std::size_t>(vertex_[side_[s].to])] -= weight * sheets * at_end * out;
    }
  }
  return area;
}

}  // namespace unwrapd::solve::repair
