// After Smith and Schaefer (2015): from an injective map downhill in the symmetric Dirichlet energy
// plus the boundary's own barrier, by steps after which the map is still injective. Steps are
// those of SLIM (Rabinovich et al. 2017), whose matrix takes in the barrier's curvature as blocks
// on the diagonal: the pattern stays that of the mesh. Neither a scaffold of triangles around the
// boundary nor collision times along the step: the exact test of the boundary alone is cheap, and a
// map that passes it is right whatever came between. The method's own energy then has the last
// word (settle_apart()).
#include "core/solve/bijective.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/cancel.hpp"
#include "core/error.hpp"
#include "core/measure/overlaps.hpp"
#include "core/solve/boundary_barrier.hpp"
#include "core/solve/convex_map.hpp"
#include "core/solve/fill_holes.hpp"
#include "core/solve/hold_align.hpp"
#include "core/solve/injective_step.hpp"
#include "core/solve/kept.hpp"
#include "core/solve/settle_apart.hpp"
#include "core/solve/symmetric_dirichlet.hpp"

namespace unwrapd {
namespace {

constexpr int kMostIterations = 300;
constexpr std::size_t kWindow = 5;   // iterations, over which the energy must fall by this share
constexpr double kTolerance = 1e-3;  // (1e-2: the map of Cow ends at a sixth more energy)

class Parting {
 public:
  Parting(const Disk& disk, const FreeVertices& free, UvMap start, Executor& executor)
      : disk_(disk),
        executor_(executor),
        barrier_(disk),
        system_(disk.faces, free, disk.stop),
        uv_(std::move(start)),
        gradient_(uv_.size()),
        blocks_(uv_.size()),
        step_(uv_.size(), Vec2::Zero()) {
    check_memory(disk, system_.bytes());
    energy_ = energy_of(uv_);
  }

  [[nodiscard]] const UvMap& uv() const { return uv_; }
  [[nodiscard]] double energy() const { return energy_; }

  /// False where no step lowers the energy.
  bool iterate() { return find_step() && search_along_step(); }

 private:
  [[nodiscard]] double energy_of(const UvMap& uv) const {
    const double own = symmetric_dirichlet_energy(disk_, uv, executor_);
    return std::isfinite(own) ? own + contact_energy(barrier_.contacts(uv), uv) : own;
  }

  void add_contacts() {
    const std::vector<Contact> contacts = barrier_.contacts(uv_);
    add_contact_gradient(contacts, uv_, gradient_);
    std::fill(blocks_.begin(), blocks_.end(), Vec3::Zero());
    add_contact_curvature(contacts, uv_, blocks_);
    for (std::size_t v = 0; v < blocks_.size(); ++v) {
      if (blocks_[v].isZero(0)) continue;
      const auto corner = static_cast<std::size_t>(disk_.corners.corner[disk_.corners.begin[v]]);
      const std::size_t i = 2 * (corner % 3);
      PairElement element{};
      element[i][i] = blocks_[v][0];
      element[i + 1][i] = blocks_[v][1];
      element[i + 1][i + 1] = blocks_[v][2];
      system_.add(corner / 3, element);
    }
  }

  bool find_step() {
    symmetric_dirichlet_gradient(disk_, uv_, gradient_, executor_);
    system_.clear();
    for (std::size_t t = 0; t < disk_.faces.size(); ++t)
      system_.add(
          t, proxy_element(disk_.rest[t], jacobian(disk_.rest[t], uv_edges(disk_.faces[t], uv_))));
    add_contacts();
    if (!system_.factor()) return false;
    std::vector<Vec2> change;
    for (std::size_t v = 1; v < uv_.size(); ++v) change.emplace_back(-gradient_[v]);
    system_.solve(change);
    std::copy(change.begin(), change.end(), step_.begin() + 1);
    return true;
  }

  bool search_along_step() {
    double slope = 0;
    for (std::size_t v = 0; v < uv_.size(); ++v) slope += gradient_[v].dot(step_[v]);
    const auto energy = [this](const UvMap& uv) { return energy_of(uv); };
    const std::optional<double> after = injective_step(disk_, step_, slope, energy, uv_);
    if (after) energy_ = *after;
    return after.has_value();
  }

  const Disk& disk_;
  Executor& executor_;
  BoundaryBarrier barrier_;
  PairSystem system_;
  UvMap uv_;
  double energy_ = 0;
  std::vector<Vec2> gradient_;
  std::vector<Vec3> blocks_;
  std::vector<Vec2> step_;
};

UvMap to_best_scale(const Disk& disk, UvMap uv) {
  const double scale = best_scale(disk, uv);
  for (Vec2& u : uv) u *= scale;
  return uv;
}

/// A map to begin with; none where double precision has none.
template <class Map>
std::optional<UvMap> start_from(const Disk& disk, Map map) {
  try {
    UvMap uv = map(fill_holes(disk).disk);
    uv.resize(disk.positions.size());
    if (!is_plainly_injective(disk.faces, disk.loops, uv)) return std::nullopt;
    uv = to_best_scale(disk, std::move(uv));
    if (is_plainly_injective(disk.faces, disk.loops, uv)) return uv;
  } catch (const Error&) {  // no such map of this mesh: there is another
    throw_if_cancelled(disk.stop);
  }
  return std::nullopt;
}

std::optional<UvMap> injective_start(const Disk& disk) {
  std::optional<UvMap> start = start_from(disk, [](const Disk& d) { return mean_value_map(d); });
  return start ? start : start_from(disk, [](const Disk& d) { return tutte_map(d); });
}

Vec2 middle_of(const UvMap& uv) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& u : uv) sum += u;
  return sum / static_cast<double>(uv.size());
}

/// The map turned and moved to where the old one was.
UvMap laid_along(const UvMap& old, const UvMap& uv) {
  const Vec2 from = middle_of(uv), to = middle_of(old);
  double cosine = 0, sine = 0;
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const Vec2 a = uv[v] - from, b = old[v] - to;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const double length = std::hypot(cosine, sine);
  if (length > 0) cosine /= length, sine /= length;
  UvMap laid;
  laid.reserve(uv.size());
  for (const Vec2& u : uv) {
    const Vec2 a = u - from;
    laid.push_back(to + Vec2(cosine * a.x() - sine * a.y(), sine * a.x() + cosine * a.y()));
  }
  return laid;
}

/// The map moved to where its springs pull it no further: nothing else feels where it lies.
UvMap moved_to_rest(UvMap uv, const std::vector<Spring>& springs) {
  Vec2 pull = Vec2::Zero();
  double weight = 0;
  for (const Spring& spring : springs) {
    pull += spring.weight * (spring.at - uv[static_cast<std::size_t>(spring.vertex)]);
    weight += spring.weight;
  }
  for (Vec2& u : uv) u += pull / weight;
  return uv;
}

/// Replaces uv by the map moved, unless moving has rounded it into an overlap.
void keep_apart(const Disk& disk, UvMap moved, UvMap& uv) {
  if (is_plainly_injective(disk.faces, disk.loops, moved)) uv = std::move(moved);
}

bool has_settled(const std::vector<double>& energy) {
  return energy.size() > kWindow &&
         energy[energy.size() - 1 - kWindow] - energy.back() <= kTolerance * energy.back();
}

}  // namespace

bool map_injectively(const Disk& disk, const MapIntent& intent, UvMap& uv, Executor& executor) {
  throw_if_cancelled(intent.stop);
  std::optional<UvMap> start = injective_start(disk);
  throw_if_cancelled(intent.stop);
  if (!start) return false;
  std::vector<char> fixed(disk.positions.size(), 0);
  fixed.front() = 1;  // translation costs nothing
  const FreeVertices free = number_free(fixed);
  Parting parting(disk, free, std::move(*start), executor);
  std::vector<double> energy{parting.energy()};
  for (int k = 0; k < kMostIterations && !has_settled(energy); ++k) {
    throw_if_cancelled(intent.stop);
    if (!parting.iterate()) break;
    energy.push_back(parting.energy());
  }
  throw_if_cancelled(intent.stop);
  UvMap settled = parting.uv();
  const bool is_drawn = !intent.springs.empty();
  if (is_drawn) keep_apart(disk, held_start(settled, {{}, intent.springs}), settled);
  settle_apart(disk, intent, settled);
  throw_if_cancelled(intent.stop);
  keep_apart(disk, is_drawn ? moved_to_rest(settled, intent.springs) : laid_along(uv, settled),
             settled);
  uv = std::move(settled);
  return true;
}

}  // namespace unwrapd
