#pragma once
// Developable shapes that are hard to unfold, for tests: strips along Hilbert's curve.

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/core/shapes.hpp"

namespace unwrapd::shapes {

using Cell = std::array<int, 2>;

/// The 4^order cells of Hilbert's curve in their order; neighbours share a side.
inline std::vector<Cell> hilbert_cells(int order) {
  std::vector<Cell> cells;
  for (int d = 0; d < 1 << 2 * order; ++d) {
    int x = 0, y = 0, rest = d;
    for (int s = 1; s < 1 << order; s *= 2, rest /= 4) {
      const int right = rest / 2 % 2, up = (rest ^ right) % 2;
      if (up == 0) {
        if (right == 1) x = s - 1 - x, y = s - 1 - y;
        std::swap(x, y);
      }
      x += s * right, y += s * up;
    }
    cells.push_back({x, y});
  }
  return cells;
}

/// A wall of the given height along the curve through the cells' centres, `sub` columns a cell: a
/// long rectangle, folded by right angles. 2 * sub * rows * (4^order - 1) faces.
inline TriMesh hilbert_wall(int order, int sub, Index rows, double height) {
  const std::vector<Cell> cells = hilbert_cells(order);
  const auto last = cells.size() - 1;
  return mapped_grid(Index(last) * sub, rows, Wrap::none, [&](double u, double v) {
    const double along = u * double(last);
    const std::size_t i = std::min(std::size_t(along + 1e-9), last - 1);
    const double f = along - double(i);
    const auto mix = [&](std::size_t k) {
      return cells[i][k] + f * (cells[i + 1][k] - cells[i][k]);
    };
    return Vec3(mix(0), mix(1), height * v);
  });
}

/// The cells themselves as a ribbon that winds through the plane, folded by up to `fold` radians
/// along every side between two cells. sub x sub quads a cell: 2 * sub^2 * 4^order faces.
inline TriMesh hilbert_ribbon(int order, int sub, double fold) {
  TriMesh mesh;
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();  // of the cell, laid out in the plane
  const std::vector<Cell> cells = hilbert_cells(order);
  const auto side = std::size_t(sub) + 1;
  std::vector<Index> before, now;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    now.assign(side * side, -1);
    if (c > 0) {
      const int dx = cells[c][0] - cells[c - 1][0], dy = cells[c][1] - cells[c - 1][1];
      const Vec3 hinge(cells[c - 1][0] + (dx > 0), cells[c - 1][1] + (dy > 0), 0);
      const Eigen::AngleAxisd turn(fold * std::sin(1.7 * double(c)),
                                   Vec3(std::abs(dy), std::abs(dx), 0));
      place = place * Eigen::Translation3d(hinge) * turn * Eigen::Translation3d(-hinge);
      for (std::size_t k = 0; k < side; ++k) {  // the shared side
        const auto at = [&](int d, std::size_t low) {
          return d > 0 ? low : d < 0 ? side - 1 - low : k;
        };
        now[at(dy, 0) * side + at(dx, 0)] = before[at(dy, side - 1) * side + at(dx, side - 1)];
      }
    }
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (now[k] >= 0) continue;
      now[k] = mesh.vertex_count();
      const double x = double(k % side) / sub, y = double(k / side) / sub;
      mesh.positions.push_back(place * Vec3(cells[c][0] + x, cells[c][1] + y, 0));
    }
    for (std::size_t j = 0; j + 1 < side; ++j)
      for (std::size_t i = 0; i + 1 < side; ++i)
        add_quad(mesh.faces, now[j * side + i], now[j * side + i + 1], now[(j + 1) * side + i + 1],
                 now[(j + 1) * side + i]);
    before.swap(now);
  }
  return mesh;
}

/// A sheet with square holes, rolled by `turn` radians: developable, 10 boundaries.
inline TriMesh pierced_roll(Index n, double turn) {
  const TriMesh sheet = mapped_grid(n, n, Wrap::none, [&](double u, double v) {
    return Vec3(std::cos(turn * u) / turn, std::sin(turn * u) / turn, v);
  });
  TriMesh mesh;
  std::vector<Index> number(sheet.positions.size(), -1);
  for (std::size_t t = 0; t < sheet.faces.size(); ++t) {
    const auto column = Index(t / 2) % n * 7 / n, row = Index(t / 2) / n * 7 / n;
    if (column % 2 == 1 && row % 2 == 1) continue;
    Triangle face = sheet.faces[t];
    for (Index& v : face) {
      Index& own = number[std::size_t(v)];
      if (own < 0)
        own = mesh.vertex_count(), mesh.positions.push_back(sheet.positions[std::size_t(v)]);
      v = own;
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

}  // namespace unwrapd::shapes
