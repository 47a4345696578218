// A sequence of maps is known, for what may follow it, by its greatest D_angle, its least D_area
// and its cost. One that another beats in all three leads nowhere: few remain at each lambda.
#include "core/pipeline/lambda_order.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>

namespace unwrapd::pipeline {
namespace {

/// The best sequence that ends with a candidate and reaches these extremes.
struct Sequence {
  double angle, area;  // the greatest and the least so far
  double cost;
  std::size_t candidate;
  std::size_t before;  // the sequence of the previous lambda that this one continues
};

bool may_follow(const Tradeoff& map, double angle, double area, double slack) {
  const auto with_slack = [slack](double d) { return d + slack * std::max(1.0, d / 4); };
  return angle <= with_slack(map.angle) && map.area <= with_slack(area);
}

/// Whether own has no less distortion than other, and is out of order with it.
bool is_excluded_by(const Tradeoff& other, const Tradeoff& own, double slack) {
  if (own.angle < other.angle || own.area < other.area) return false;
  return own.lambda < other.lambda ? !may_follow(other, own.angle, own.area, slack)
                                   : !may_follow(own, other.angle, other.area, slack);
}

/// The candidates that no other excludes. There is one: exclusion means more distortion.
std::vector<std::size_t> without_excluded(std::span<const Tradeoff> candidates, double slack) {
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c < candidates.size(); ++c)
    if (std::ranges::none_of(candidates, [&](const Tradeoff& other) {
          return is_excluded_by(other, candidates[c], slack);
        }))
      kept.push_back(c);
  return kept;
}

/// The sequences that no other beats, cheapest first.
std::vector<Sequence> unbeaten(std::vector<Sequence> all) {
  std::ranges::stable_sort(all, {}, &Sequence::cost);
  std::vector<Sequence> kept;
  for (const Sequence& own : all)
    if (std::ranges::none_of(kept, [&](const Sequence& other) {
          return other.angle <= own.angle && other.area >= own.area;
        }))
      kept.push_back(own);
  return kept;
}

}  // namespace

bool is_ordered(std::span<const Tradeoff> maps, double slack) {
  double angle = 0, area = std::numeric_limits<double>::infinity();
  for (const Tradeoff& map : maps) {
    if (!may_follow(map, angle, area, slack)) return false;
    angle = std::max(angle, map.angle), area = std::min(area, map.area);
  }
  return true;
}

std::vector<std::size_t> choose_in_order(std::span<const Tradeoff> candidates,
                                         std::size_t lambda_count, double slack,
                                         const CandidateCost& cost) {
  assert(lambda_count > 0 && !candidates.empty());
  const std::vector<std::size_t> usable = without_excluded(candidates, slack);
  std::vector<std::vector<Sequence>> sequences{
      {{0, std::numeric_limits<double>::infinity(), 0, 0, 0}}};
  for (std::size_t k = 0; k < lambda_count; ++k) {
    std::vector<Sequence> longer;
    for (std::size_t s = 0; s < sequences.back().size(); ++s) {
      const Sequence& own = sequences.back()[s];
      for (const std::size_t c : usable)
        if (may_follow(candidates[c], own.angle, own.area, slack))
          longer.push_back({std::max(own.angle, candidates[c].angle),
                            std::min(own.area, candidates[c].area), own.cost + cost(k, c), c, s});
    }
    sequences.push_back(unbeaten(std::move(longer)));
  }
  std::vector<std::size_t> chosen(lambda_count);
  for (std::size_t k = lambda_count, s = 0; k-- > 0;) {
    std::tie(chosen[k], s) = std::tuple(sequences[k + 1][s].candidate, sequences[k + 1][s].before);
  }
  return chosen;
}

}  // namespace unwrapd::pipeline
