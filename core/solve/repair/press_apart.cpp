// The area that is covered twice (overlap_area.hpp) is one more energy, whose weight is doubled
// every few steps: sheets give way to each other as far as they must, and the method's own energy
// rises from its least value as little as it can. No barrier is needed, and so no injective map to
// start from; the steps are ARAP's own, with the factor of its global step (accelerate.hpp). From a
// convex map by Newton's method (bijective.hpp) the same takes ten to thirty times as long.
#include "core/solve/repair/press_apart.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/arap/accelerate_memory.hpp"
#include "core/solve/arap/objective.hpp"
#include "core/solve/repair/overlap_area.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr double kGapOfSides = 0.05;    // between sheets, in mean boundary edges
constexpr double kFirstPressure = 0.2;  // of the energy, for all of the first overlap
constexpr double kSmallOverlap = 3e-3;  // of the surface: what overlaps less is pressed no harder
constexpr double kHarder = 2;           // from one stage to the next
constexpr int kStepsOfAStage = 5, kMostStages = 20;
constexpr double kNearlyApart = 0.01;    // of the first overlap
constexpr double kArmijoOfPress = 1e-4;  // the line search, as in accelerate.cpp
constexpr int kHalvingsOfPress = 5;
constexpr double kFewFlipped = 1e-3;  // of all faces, that a repair may turn back at the end

double mean_side(const Disk& disk) {
  double length = 0, count = 0;
  for (const BoundaryLoop& loop : disk.loops)
    for (const Index h : loop) {
      length += disk.rest[h / 3].edge[static_cast<std::size_t>(h % 3)].norm();
      ++count;
    }
  return length / count;
}

struct PressedEnergy {
  double own = 0, overlap = 0;
};

/// One descent, in rank order.
class Pressing {
 public:
  Pressing(const Disk& disk, const MapIntent& intent, const arap::GlobalStep& global,
           const UvMap& start, Executor& executor)
      : global_(global),
        objective_(disk, intent.rigidity, {}, global.rank(), executor),
        overlap_(disk, global.rank(), kGapOfSides * mean_side(disk)),
        memory_(executor),
        uv_(arap::by_rank(start, global.rank())),
        trial_(uv_.size()) {
    for (auto* vector : {&now_.force, &now_.plain, &before_.force, &before_.plain, &step_,
                         &direction_, &force_at_trial_})
      vector->resize(uv_.size());
    energy_ = evaluate(uv_, now_.force);
    if (energy_.overlap > 0)
      weight_ = kFirstPressure * energy_.own / std::max(energy_.overlap, kSmallOverlap);
  }

  [[nodiscard]] bool can_press() const { return weight_ > 0; }
  [[nodiscard]] const PressedEnergy& energy() const { return energy_; }
  [[nodiscard]] UvMap map() const { return arap::by_vertex(uv_, global_.rank()); }

  /// Some steps under the present weight, which is raised for the next ones.
  void press(const std::stop_token& stop) {
    memory_.forget();
    has_stepped_ = false;
    energy_ = evaluate(uv_, now_.force);
    for (int k = 0; k < kStepsOfAStage; ++k) {
      throw_if_cancelled(stop);
      if (!step()) break;
    }
    weight_ *= kHarder;
  }

 private:
  PressedEnergy evaluate(std::span<const Vec2> uv, std::span<Vec2> force) {
    PressedEnergy energy;
    energy.own = objective_.evaluate(uv, force);
    energy.overlap = overlap_.evaluate(uv, weight_, force);
    return energy;
  }
  [[nodiscard]] double total(const PressedEnergy& energy) const {
    return energy.own + weight_ * energy.overlap;
  }

  bool step() {
    now_.plain = now_.force;
    global_.solve_by_rank(now_.plain);
    if (std::exchange(has_stepped_, false)) memory_.learn(step_, before_, now_);
    const bool is_plain = memory_.empty();
    if (advance(memory_.direct(now_, direction_))) return true;
    if (is_plain) return false;
    memory_.forget();
    return advance(memory_.direct(now_, direction_));
  }

  bool advance(double slope) {
    if (!(slope > 0)) return false;
    double length = 1;
    for (int k = 0; k <= kHalvingsOfPress; ++k, length /= 2) {
      for (std::size_t v = 0; v < trial_.size(); ++v) trial_[v] = uv_[v] + length * direction_[v];
      const PressedEnergy energy = evaluate(trial_, force_at_trial_);
      if (!(total(energy) <= total(energy_) - kArmijoOfPress * length * slope)) continue;
      for (std::size_t v = 0; v < trial_.size(); ++v) step_[v] = trial_[v] - uv_[v];
      std::swap(now_, before_);
      std::swap(now_.force, force_at_trial_);
      std::swap(uv_, trial_);
      energy_ = energy;
      has_stepped_ = true;
      return true;
    }
    return false;
  }

  const arap::GlobalStep& global_;
  arap::Objective objective_;
  OverlapArea overlap_;
  arap::StepMemory memory_;
  arap::Slope now_, before_;
  UvMap uv_, trial_;
  std::vector<Vec2> step_, direction_, force_at_trial_;
  PressedEnergy energy_;
  double weight_ = 0;
  bool has_stepped_ = false;  ///< step_ has not been learnt yet
};

/// Whether the map is injective, perhaps after a few triangles were turned back where they are.
bool is_apart(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  const std::size_t flips = measure::flipped_faces(disk.faces, uv, intent.stop).size();
  if (flips > 1 + static_cast<std::size_t>(kFewFlipped * static_cast<double>(disk.faces.size())))
    return false;
  if (flips > 0) {
    MapIntent own = intent;
    own.in_place = true;
    if (untangle(disk, own, uv) > 0) return false;
  }
  return measure::is_plainly_injective(disk.faces, disk.loops, uv, intent.stop);
}

}  // namespace

bool press_apart(const Disk& disk, const MapIntent& intent, double most_rise, UvMap& uv) {
  SerialExecutor serial;
  JobExecutor job(intent.executor != nullptr ? *intent.executor : serial, intent.stop);
  std::optional<arap::GlobalStep> made;
  const arap::GlobalStep& global =
      intent.global != nullptr ? *intent.global : made.emplace(disk, VertexConstraints{}, &job);
  Pressing pressing(disk, intent, global, uv, job);
  if (!pressing.can_press()) return false;
  const PressedEnergy first = pressing.energy();
  for (int k = 0; k < kMostStages; ++k) {
    pressing.press(intent.stop);
    if (pressing.energy().own > (1 + most_rise) * first.own) return false;
    if (pressing.energy().overlap > kNearlyApart * first.overlap) continue;
    UvMap apart = pressing.map();
    if (!is_apart(disk, intent, apart)) continue;
    uv = std::move(apart);
    return true;
  }
  return false;
}

}  // namespace unwrapd::solve::repair
