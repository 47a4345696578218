// Constraints are located in their order, then sorted by chart and vertex. Those of one vertex are
// merged, and contradictions are refused before anything is solved.
#include "core/charts/constraints.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/charts/vertex_finder.hpp"
#include "core/mesh/counting_sort.hpp"

namespace unwrapd::charts {
namespace {

/// A constraint and the vertex that it applies to.
struct Pin {
  Index vertex = 0;      ///< of the chart
  Index constraint = 0;  ///< its number
  Vec2 at = Vec2::Zero();
  double weight = 0;

  [[nodiscard]] bool is_hard() const { return std::isinf(weight); }
};

using ChartPins = std::vector<Pin>;

[[noreturn]] void refuse(const std::string& what, std::size_t constraint) {
  throw Error(ErrorCode::invalid_constraint, what, "/constraints/" + std::to_string(constraint));
}

std::string text(const Vec2& uv) {
  std::ostringstream out;
  out << "(" << std::setprecision(9) << uv.x() << ", " << uv.y() << ")";
  return out.str();
}

std::string number(Index constraint) { return "constraint " + std::to_string(constraint); }

Eigen::Vector2f to_float(const Vec2& uv) { return uv.cast<float>(); }

void check_range(const PositionConstraint& c, std::span<const Surface> surfaces, std::size_t i) {
  const auto count = static_cast<Index>(surfaces.size());
  if (c.surface < 0 || c.surface >= count)
    refuse("there is no mesh " + std::to_string(c.surface) + "; name one of the asset's " +
               std::to_string(count) + ", counted from 0",
           i);
  const Index vertices = surfaces[static_cast<std::size_t>(c.surface)].mesh.vertex_count();
  if (c.vertex && (*c.vertex < 0 || *c.vertex >= vertices))
    refuse("there is no vertex " + std::to_string(*c.vertex) + "; name one of the mesh's " +
               std::to_string(vertices) + ", counted from 0, or a point in space",
           i);
  if (!std::isinf(c.weight) &&
      !(c.weight >= kMinConstraintWeight && c.weight <= kMaxConstraintWeight))
    refuse("weight must lie between 1e-9 and 1e9; leave it out to fix the vertex exactly", i);
  if (!to_float(c.uv).allFinite())
    refuse("uv is too large for a 32-bit float; give a position on or near the page, [0,1]", i);
}

std::vector<ChartVertex> find(const VertexFinder& finder, const PositionConstraint& c,
                              std::size_t i) {
  if (!c.vertex) {
    const std::optional<Index> nearest = finder.nearest(c.position);
    if (!nearest) refuse("the mesh has no triangles; name another", i);
    return finder.at_place_of(*nearest);
  }
  std::vector<ChartVertex> found = finder.of_vertex(*c.vertex);
  if (found.empty())
    refuse("vertex " + std::to_string(*c.vertex) +
               " belongs to no triangle with an area; name another vertex, or a point in space",
           i);
  return found;
}

/// For each surface, each chart: its pins in the order of the constraints.
std::vector<std::vector<ChartPins>> find_all(std::span<const Surface> surfaces,
                                             std::span<const Charts> charts,
                                             std::span<const PositionConstraint> constraints,
                                             const std::stop_token& stop) {
  std::vector<std::vector<ChartPins>> pins;
  for (const Charts& part : charts) pins.emplace_back(part.charts.size());
  std::vector<std::optional<VertexFinder>> finders(surfaces.size());
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    throw_if_cancelled(stop);
    const PositionConstraint& c = constraints[i];
    check_range(c, surfaces, i);
    const auto s = static_cast<std::size_t>(c.surface);
    if (!finders[s]) finders[s].emplace(surfaces[s], charts[s]);
    for (const ChartVertex& v : find(*finders[s], c, i))
      pins[s][static_cast<std::size_t>(v.chart)].push_back(
          {v.vertex, static_cast<Index>(i), c.uv, c.weight});
  }
  return pins;
}

/// The hard pin of one vertex, the first of equal ones.
const Pin* hard_pin(std::span<const Pin> pins) {
  const Pin* hard = nullptr;
  for (const Pin& pin : pins) {
    if (!pin.is_hard()) continue;
    if (hard == nullptr) hard = &pin;
    if (to_float(pin.at) != to_float(hard->at))
      refuse(number(hard->constraint) + " places the same vertex at " + text(hard->at) +
                 "; remove one of the two, or give both a finite weight",
             static_cast<std::size_t>(pin.constraint));
  }
  return hard;
}

/// Merges soft constraints of one vertex: sum w |u - p|^2 is W |u - sum w p / W|^2 plus a constant.
solve::SoftConstraint merge_soft(std::span<const Pin> pins) {
  solve::SoftConstraint soft_constraint{pins.front().vertex, Vec2::Zero(), 0};
  for (const Pin& pin : pins) soft_constraint.weight += pin.weight;
  for (const Pin& pin : pins) soft_constraint.at += pin.weight / soft_constraint.weight * pin.at;
  return soft_constraint;
}

/// pins: the hard ones of a chart, one a vertex.
void check_apart(ChartPins pins) {
  const auto before = [](const Pin& a, const Pin& b) {
    const Eigen::Vector2f p = to_float(a.at), q = to_float(b.at);
    return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y();
  };
  std::stable_sort(pins.begin(), pins.end(), before);
  for (std::size_t k = 1; k < pins.size(); ++k) {
    if (before(pins[k - 1], pins[k])) continue;
    const auto [first, second] = std::minmax(pins[k - 1].constraint, pins[k].constraint);
    refuse(number(first) + " places another vertex at the same uv " + text(pins[k].at) +
               "; give them different positions, or give one of them a finite weight",
           static_cast<std::size_t>(second));
  }
}

void check_spread(const solve::VertexConstraints& holds, const ChartPins& pins) {
  Vec2 first = holds.hard.empty() ? holds.soft.front().at : holds.hard.front().at;
  bool apart = holds.count() == 1;
  for (const solve::HardConstraint& p : holds.hard)
    apart = apart || to_float(p.at) != to_float(first);
  for (const solve::SoftConstraint& s : holds.soft)
    apart = apart || to_float(s.at) != to_float(first);
  if (!apart)
    refuse("all constraints of this chart have the position " + text(first) +
               ", so they do not determine its size; give one of them another position, or keep "
               "only one",
           static_cast<std::size_t>(pins.back().constraint));
}

/// pins: of one chart, not empty, in the order of the constraints.
solve::VertexConstraints merge(const ChartPins& pins, Index vertex_count) {
  solve::VertexConstraints holds;
  ChartPins hard_pins, sorted = pins;
  counting_sort(sorted, vertex_count, [](const Pin& pin) { return std::size_t(pin.vertex); });
  for_each_run(
      sorted, [](const Pin& a, const Pin& b) { return a.vertex == b.vertex; },
      [&](const Pin* first, const Pin* last) {
        if (const Pin* hard = hard_pin({first, last}))
          hard_pins.push_back(*hard);
        else
          holds.soft.push_back(merge_soft({first, last}));
      });
  for (const Pin& pin : hard_pins) holds.hard.push_back({pin.vertex, pin.at});
  check_apart(std::move(hard_pins));
  check_spread(holds, pins);
  return holds;
}

[[noreturn]] void refuse_free(const Chart& chart, std::size_t surface) {
  throw Error(ErrorCode::invalid_constraint,
              "the chart with face " + std::to_string(chart.face_source.front()) + " of mesh " +
                  std::to_string(surface) +
                  " has no constraint, so its place on the page is unknown; constrain a vertex of "
                  "every chart, or of none",
              "/constraints");
}

}  // namespace

std::vector<std::vector<solve::VertexConstraints>> page_constraints(
    std::span<const Surface> surfaces, std::span<const Charts> charts,
    std::span<const PositionConstraint> constraints, const std::stop_token& stop) {
  std::vector<std::vector<solve::VertexConstraints>> holds;
  for (const Charts& part : charts) holds.emplace_back(part.charts.size());
  if (constraints.empty()) return holds;
  const std::vector<std::vector<ChartPins>> pins = find_all(surfaces, charts, constraints, stop);
  for (std::size_t s = 0; s < holds.size(); ++s)
    for (std::size_t k = 0; k < holds[s].size(); ++k) {
      const Chart& chart = charts[s].charts[k];
      if (pins[s][k].empty()) refuse_free(chart, s);
      holds[s][k] = merge(pins[s][k], chart.mesh.vertex_count());
    }
  return holds;
}

}  // namespace unwrapd::charts
