// Charts' UVs back onto the surface: a vertex is split where the corners that share it ended in
// different places of the atlas.
//
// A corner is a pair (vertex of the surface, vertex of a chart). Equal pairs are found by sorting,
// so a vertex with a million copies costs no more than a million vertices.
#include "core/pipeline/assemble.hpp"

#include <cassert>

#include "core/base/cancel.hpp"
#include "core/mesh/counting_sort.hpp"
#include "core/pipeline/set_aside.hpp"
#include "core/solve/base/cached.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr Index kNone = -1, kSeveral = -2;  // corners

/// The vertices of all charts in one numbering: chart k's begin at first[k].
struct Numbering {
  std::vector<Index> first;

  [[nodiscard]] Index total() const { return first.back(); }
};

Numbering number_vertices(std::span<const charts::Chart* const> charts) {
  Numbering numbering{{0}};
  for (const charts::Chart* chart : charts)
    numbering.first.push_back(numbering.first.back() + chart->mesh.vertex_count());
  return numbering;
}

/// at[corner]: the chart vertex that it shows; kUncharted for faces that are set aside.
std::vector<Triangle> charted_corners(const Surface& surface,
                                      std::span<const charts::Chart* const> charts,
                                      const Numbering& numbering, const std::stop_token& stop) {
  std::vector<Triangle> at(surface.mesh.faces.size(), {kUncharted, kUncharted, kUncharted});
  for (std::size_t k = 0; k < charts.size(); ++k) {
    const charts::Chart& chart = *charts[k];
    for (std::size_t t = 0; t < chart.face_source.size(); ++t) {
      check_cancelled_every(t, stop);
      for (std::size_t i = 0; i < 3; ++i)
        at[chart.face_source[t]][i] = numbering.first[k] + chart.mesh.faces[t][i];
    }
  }
  return at;
}

/// For each vertex its first corner, kSeveral where its corners show several chart vertices.
std::vector<Index> first_corners(const std::vector<Triangle>& faces, Index vertex_count,
                                 const std::vector<Triangle>& at, const std::stop_token& stop) {
  std::vector<Index> first(vertex_count, kNone);
  for (Index c = 0; c < static_cast<Index>(3 * faces.size()); ++c) {
    check_cancelled_every(c, stop);
    Index& own = first[faces[c / 3][c % 3]];
    if (own == kNone) own = c;
    if (own != kSeveral && at[own / 3][own % 3] != at[c / 3][c % 3]) own = kSeveral;
  }
  return first;
}

/// For each corner 3t + i, the first corner with the same vertex and the same chart vertex.
std::vector<Index> first_equal_corners(const std::vector<Triangle>& faces, Index vertex_count,
                                       const std::vector<Triangle>& at, Index chart_vertex_count,
                                       const std::stop_token& stop) {
  struct Corner {
    Index vertex, shown, corner;
  };
  std::vector<Index> first_equal(3 * faces.size());
  const std::vector<Index> first_of = first_corners(faces, vertex_count, at, stop);
  std::vector<Corner> corners;  // at vertices that show several
  for (Index c = 0; c < static_cast<Index>(3 * faces.size()); ++c) {
    check_cancelled_every(c, stop);
    const Index v = faces[c / 3][c % 3];
    first_equal[c] = first_of[v];
    if (first_of[v] == kSeveral) corners.push_back({v, at[c / 3][c % 3] + 1, c});
  }
  if (corners.empty()) return first_equal;
  counting_sort(
      corners, chart_vertex_count + 1, [](const Corner& c) { return c.shown; }, stop);
  counting_sort(
      corners, vertex_count, [](const Corner& c) { return c.vertex; }, stop);
  for_each_run(
      corners,
      [](const Corner& a, const Corner& b) { return a.vertex == b.vertex && a.shown == b.shown; },
      [&](const Corner* first, const Corner* last) {
        for (const Corner* c = first; c < last; ++c) first_equal[c->corner] = first->corner;
      },
      stop);
  return first_equal;
}

UvMap joined(std::span<const UvMap> chart_uv) {
  UvMap all;
  for (const UvMap& uv : chart_uv) all.insert(all.end(), uv.begin(), uv.end());
  return all;
}

}  // namespace

VertexPlan plan_vertices(const Surface& surface, const charts::Charts& whole,
                         std::span<const charts::Chart* const> charts,
                         const std::stop_token& stop) {
  const Numbering numbering = number_vertices(charts);
  std::vector<Triangle> at = charted_corners(surface, charts, numbering, stop);
  place_set_aside(surface, whole, stop, at);
  throw_if_cancelled(stop);
  const std::vector<Triangle>& faces = surface.mesh.faces;
  const Index vertex_count = surface.mesh.vertex_count();
  const std::vector<Index> first_equal =
      first_equal_corners(faces, vertex_count, at, numbering.total(), stop);
  throw_if_cancelled(stop);
  VertexPlan plan{faces, std::vector<Index>(vertex_count),
                  std::vector<Index>(vertex_count, kUncharted)};
  for (Index v = 0; v < vertex_count; ++v) plan.source[v] = v;
  std::vector<bool> taken(vertex_count, false);
  for (Index c = 0; c < static_cast<Index>(first_equal.size()); ++c) {
    check_cancelled_every(c, stop);
    const Index first = first_equal[c], v = faces[c / 3][c % 3];
    Index& number = plan.faces[c / 3][c % 3];
    if (first != c) {
      number = plan.faces[first / 3][first % 3];
      continue;
    }
    if (taken[v]) {
      number = static_cast<Index>(plan.source.size());
      plan.source.push_back(v);
      plan.shown.push_back(kUncharted);
    }
    taken[v] = true;
    plan.shown[number] = at[c / 3][c % 3];
  }
  return plan;
}

std::size_t bytes_of(const VertexPlan& plan) {
  return solve::bytes_of(plan.faces) + solve::bytes_of(plan.source) + solve::bytes_of(plan.shown);
}

UnwrappedSurface assemble(const VertexPlan& plan, std::span<const UvMap> chart_uv) {
  const UvMap uv = joined(chart_uv);
  UnwrappedSurface out{plan.faces, plan.source, UvMap(plan.shown.size(), Vec2::Zero())};
  for (std::size_t v = 0; v < plan.shown.size(); ++v)
    if (plan.shown[v] != kUncharted) out.uv[v] = uv[plan.shown[v]];
  return out;
}

UnwrappedSurface assemble(const Surface& surface, const charts::Charts& charts,
                          std::span<const UvMap> chart_uv, const std::stop_token& stop) {
  assert(chart_uv.size() == charts.charts.size());
  return assemble(plan_vertices(surface, charts, pointers_to(charts.charts), stop), chart_uv);
}

std::vector<const charts::Chart*> pointers_to(std::span<const charts::Chart> charts) {
  std::vector<const charts::Chart*> pointers;
  for (const charts::Chart& chart : charts) pointers.push_back(&chart);
  return pointers;
}

}  // namespace unwrapd::pipeline
