// Assembly by counting: the faces bound the lengths of columns, entries are appended to their
// column, and each column, a handful of entries, is sorted and merged in place. It needs no
// triplets and no hash maps.
#include "core/linear/sparse.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::linear {
namespace {

constexpr std::size_t kFew = 16;  // entries that are sorted by insertion, without a buffer

struct OffDiagonal {
  Index row;
  double value;
};

/// Off-diagonal entries of each column of the lower triangle, unmerged, and the diagonal.
struct ColumnLists {
  std::vector<Index> begin;
  std::vector<OffDiagonal> entries;
  std::vector<double> diagonal;
};

ColumnLists scatter(std::span<const Triangle> faces, Index vertex_count,
                    std::span<const double> weight, const std::stop_token& stop) {
  const auto n = static_cast<std::size_t>(vertex_count);
  ColumnLists c{std::vector<Index>(n + 1, 0), std::vector<OffDiagonal>(3 * faces.size()),
                std::vector<double>(n, 0.0)};
  const auto ends = [&](std::size_t h) {
    const Triangle& f = faces[h / 3];
    return std::minmax(f[h % 3], f[(h + 1) % 3]);
  };
  for (std::size_t h = 0; h < 3 * faces.size(); ++h) {
    check_cancelled_every(h, stop);
    ++c.begin[static_cast<std::size_t>(ends(h).first) + 1];
  }
  for (std::size_t j = 0; j < n; ++j) c.begin[j + 1] += c.begin[j];
  std::vector<Index> next(c.begin.begin(), c.begin.end() - 1);
  for (std::size_t h = 0; h < 3 * faces.size(); ++h) {
    check_cancelled_every(h, stop);
    const auto [low, high] = ends(h);
    const auto column = static_cast<std::size_t>(low);
    c.entries[static_cast<std::size_t>(next[column]++)] = {high, -weight[h]};
    c.diagonal[column] += weight[h];
    c.diagonal[static_cast<std::size_t>(high)] += weight[h];
  }
  return c;
}

/// Stable, by row. A column usually has about six entries; one may have all.
void sort_by_row(std::span<OffDiagonal> column) {
  const auto is_lower = [](const OffDiagonal& a, const OffDiagonal& b) { return a.row < b.row; };
  if (column.size() > kFew) {
    std::stable_sort(column.begin(), column.end(), is_lower);
    return;
  }
  for (std::size_t k = 1; k < column.size(); ++k)
    for (std::size_t i = k; i > 0 && is_lower(column[i], column[i - 1]); --i)
      std::swap(column[i], column[i - 1]);
}

/// Adds up entries of the same row, in ascending order; returns how many are left.
std::size_t merge(std::span<OffDiagonal> column) {
  sort_by_row(column);
  std::size_t kept = 0;
  for (const OffDiagonal& entry : column) {
    if (kept > 0 && column[kept - 1].row == entry.row)
      column[kept - 1].value += entry.value;
    else
      column[kept++] = entry;
  }
  return kept;
}

}  // namespace

SparseMatrix lower_laplacian(std::span<const Triangle> faces, Index vertex_count,
                             std::span<const double> weight, Executor& executor) {
  assert(weight.size() == 3 * faces.size());
  ColumnLists columns = scatter(faces, vertex_count, weight, executor.stop());
  const auto n = static_cast<std::size_t>(vertex_count);
  const auto column = [&](std::size_t j) {
    return std::span(columns.entries.begin() + columns.begin[j],
                     columns.entries.begin() + columns.begin[j + 1]);
  };
  SparseMatrix lower(vertex_count, vertex_count);
  const std::span<Index> begin(lower.outerIndexPtr(), n + 1);
  for_each_part(n, executor, [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t j = first; j < end; ++j)
      begin[j + 1] = 1 + static_cast<Index>(merge(column(j)));
  });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  lower.resizeNonZeros(begin.back());
  for_each_part(n, executor, [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t j = first; j < end; ++j) {
      Index to = begin[j];
      const auto put = [&](Index row, double value) {
        lower.innerIndexPtr()[to] = row, lower.valuePtr()[to++] = value;
      };
      put(static_cast<Index>(j), columns.diagonal[j]);
      for (const OffDiagonal& e : column(j).first(static_cast<std::size_t>(begin[j + 1] - to)))
        put(e.row, e.value);
    }
  });
  return lower;
}

SparseMatrix lower_laplacian(std::span<const Triangle> faces, Index vertex_count,
                             std::span<const double> weight, const std::stop_token& stop) {
  SerialExecutor serial;
  JobExecutor job(serial, stop);
  return lower_laplacian(faces, vertex_count, weight, job);
}

VertexCorners vertex_corners(std::span<const Triangle> faces, Index vertex_count,
                             const std::stop_token& stop) {
  std::vector<Index> begin(static_cast<std::size_t>(vertex_count) + 1, 0);
  std::vector<Index> corner(3 * faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    check_cancelled_every(t, stop);
    for (Index v : faces[t]) ++begin[static_cast<std::size_t>(v) + 1];
  }
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<Index> next(begin.begin(), begin.end() - 1);
  for (std::size_t c = 0; c < 3 * faces.size(); ++c) {
    check_cancelled_every(c, stop);
    const auto v = static_cast<std::size_t>(faces[c / 3][c % 3]);
    corner[static_cast<std::size_t>(next[v]++)] = static_cast<Index>(c);
  }
  return {std::move(begin), std::move(corner)};
}

}  // namespace unwrapd::linear
