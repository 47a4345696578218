#include "core/pipeline/order_layouts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/measure/rest_triangle.hpp"
#include "core/pipeline/lambda_order.hpp"
#include "core/pipeline/place_islands.hpp"
#include "core/solve/hybrid_energy.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kListSlack = 1e-3;

/// The layout of another lambda, reported as one of this lambda.
Layout for_lambda(double lambda, Layout layout, const UnwrapOptions& options, Executor& executor) {
  auto report = layout.report.charts.begin();
  for (std::size_t s = 0; s < layout.islands.size(); ++s)
    for (std::size_t k = 0; k < layout.islands[s].size(); ++k, ++report) {
      const TriMesh& mesh = layout.charts[s][k]->mesh;
      UvMap uv = layout.islands[s][k];
      to_page_widths(uv, layout.report.page);
      const auto rest = measure::flatten(mesh.positions, mesh.faces, executor);
      report->iterations = 0;
      report->stop_reason = StopReason::neighbour;
      report->energy = solve::hybrid_energies({rest, mesh.faces, uv}, std::span(&lambda, 1),
                                              options.lambda_units, executor);
    }
  return layout;
}

double distance(std::size_t lambda, std::size_t candidate) {
  return std::abs(static_cast<double>(lambda) - static_cast<double>(candidate));
}

void note_other_maps(Layout& layout) {
  const auto count =
      std::ranges::count(layout.report.charts, StopReason::neighbour, &ChartReport::stop_reason);
  if (count == 0) return;
  layout.report.notes.push_back(
      {NoteCode::lambda_repeated,
       "Charts whose map comes from that of another lambda of the list: " + std::to_string(count) +
           ". Their own map would have more distortion than a greater lambda's of angles, or "
           "than a smaller one's of areas. A job with this lambda alone returns it."});
}

}  // namespace

void order_layouts(std::vector<Layout>& layouts, const UnwrapOptions& options, Executor& executor) {
  if (!keeps_order(options)) return;
  const std::vector<double> lambdas = lambdas_of(options);
  const std::vector<std::size_t> ascending = ascending_order(lambdas);
  std::vector<Tradeoff> tradeoffs;
  for (const std::size_t k : ascending) {
    const Distortion& d = layouts[k].report.distortion;
    tradeoffs.push_back({d.angle, d.area, tradeoffs.size()});
  }
  if (!is_ordered(tradeoffs, kListSlack)) {
    const auto chosen = choose_in_order(tradeoffs, lambdas.size(), kListSlack, distance);
    const std::vector<Layout> own = layouts;
    for (std::size_t k = 0; k < chosen.size(); ++k)
      if (chosen[k] != k)
        layouts[ascending[k]] =
            for_lambda(lambdas[ascending[k]], own[ascending[chosen[k]]], options, executor);
  }
  for (Layout& layout : layouts) note_other_maps(layout);
}

}  // namespace unwrapd::pipeline
