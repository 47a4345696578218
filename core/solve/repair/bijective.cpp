// After Smith and Schaefer (2015): from an injective map downhill in the symmetric Dirichlet energy
// plus the boundary's own barrier, by steps after which the map is still injective; then in the
// method's own energy (settle_apart()). Maps of angles are unfolded over the surface, too, before
// they are over the method's own map: straight to that one Cow's legs get stuck. Neither a scaffold
// of triangles around the boundary nor collision times along the step: the exact test of the
// boundary alone is cheap, and a map that passes it is right whatever came between.
#include "core/solve/repair/bijective.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/measure/distortion.hpp"
#include "core/measure/orientation.hpp"
#include "core/measure/overlaps.hpp"
#include "core/mesh/cross.hpp"
#include "core/solve/base/align_constrained.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/solve/repair/settle_apart.hpp"

namespace unwrapd::solve::repair {
namespace {

/// A target for a map: a disk with rest triangles, and the weight of each in the energy (empty: its
/// area).
struct Target {
  Disk disk;
  std::vector<double> share;
};

/// The surface itself; for methods of angles the method's own map without flips, whose angles the
/// new map then approximates, and whose sizes it keeps if nothing presses.
Target target_of(const Disk& disk, const MapIntent& intent, const UvMap& uv) {
  if (intent.own != OwnEnergy::mips || !measure::flipped_faces(disk.faces, uv, intent.stop).empty())
    return {disk, {}};
  TriMesh mesh;
  mesh.faces.assign(disk.faces.begin(), disk.faces.end());
  for (const Vec2& u : uv) mesh.positions.emplace_back(u.x(), u.y(), 0);
  Target target{disk, {}};
  target.disk.rest = measure::flatten(mesh, intent.stop);
  for (const measure::RestTriangle& rest : disk.rest) target.share.push_back(rest.area);
  return target;
}

UvMap to_best_scale(const Disk& disk, UvMap uv) {
  const double scale = methods::best_scale(disk, uv);
  for (Vec2& u : uv) u *= scale;
  return uv;
}

/// The map at its best scale, if it is injective at both.
std::optional<UvMap> if_injective(const Disk& disk, UvMap uv) {
  const auto is_injective = [&] {
    return measure::is_plainly_injective(disk.faces, disk.loops, uv);
  };
  if (uv.size() != disk.positions.size() || !is_injective()) return std::nullopt;
  uv = to_best_scale(disk, std::move(uv));
  return is_injective() ? std::optional(std::move(uv)) : std::nullopt;
}

/// An injective map to start from; empty if double precision gives none.
template <class Map>
std::optional<UvMap> start_from(const Disk& disk, Map map) {
  try {
    UvMap uv = map(maps::fill_holes(disk).disk);
    uv.resize(disk.positions.size());
    return if_injective(disk, std::move(uv));
  } catch (const Error&) {  // this map does not exist; try the other one
    throw_if_cancelled(disk.stop);
  }
  return std::nullopt;
}

std::optional<UvMap> injective_start(const Disk& disk, const UvMap& given) {
  if (std::optional<UvMap> start = if_injective(disk, given)) return start;
  std::optional<UvMap> start =
      start_from(disk, [](const Disk& d) { return maps::mean_value_map(d); });
  return start ? start : start_from(disk, [](const Disk& d) { return maps::tutte_map(d); });
}

Vec2 middle_of(const UvMap& uv) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& u : uv) sum += u;
  return sum / static_cast<double>(uv.size());
}

/// The map rotated and moved to where the old one was.
UvMap align_with(const UvMap& old, const UvMap& uv) {
  const Vec2 from = middle_of(uv), to = middle_of(old);
  double cosine = 0, sine = 0;
  for (std::size_t v = 0; v < uv.size(); ++v) {
    const Vec2 a = uv[v] - from, b = old[v] - to;
    cosine += a.dot(b);
    sine += cross(a, b);
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

UvMap of_the_area_of(const UvMap& old, const Disk& disk, UvMap uv) {
  const double scale = std::sqrt(measure::uv_area(disk.rest, disk.faces, old) /
                                 measure::uv_area(disk.rest, disk.faces, uv));
  for (Vec2& u : uv) u *= scale;
  return uv;
}

/// Moves the map to the mean of its soft constraints' residuals; no other energy depends on
/// translation.
UvMap translate_to_rest(UvMap uv, const std::vector<SoftConstraint>& soft) {
  Vec2 pull = Vec2::Zero();
  double weight = 0;
  for (const SoftConstraint& soft_constraint : soft) {
    pull += soft_constraint.weight *
            (soft_constraint.at - uv[static_cast<std::size_t>(soft_constraint.vertex)]);
    weight += soft_constraint.weight;
  }
  for (Vec2& u : uv) u += pull / weight;
  return uv;
}

/// Replaces uv by the map moved, unless rounding made it overlap.
void keep_apart(const Disk& disk, UvMap moved, UvMap& uv) {
  if (measure::is_plainly_injective(disk.faces, disk.loops, moved)) uv = std::move(moved);
}

}  // namespace

bool map_injectively(const Disk& disk, const MapIntent& intent, UvMap& uv, const UvMap& given) {
  throw_if_cancelled(intent.stop);
  std::optional<UvMap> start = injective_start(disk, given);
  throw_if_cancelled(intent.stop);
  if (!start) return false;
  const Target target = target_of(disk, intent, uv);
  UvMap settled = std::move(*start);
  unfold_apart(disk, {}, intent.stop, settled);
  if (!target.share.empty()) {
    keep_apart(disk, of_the_area_of(uv, disk, settled), settled);
    unfold_apart(target.disk, target.share, intent.stop, settled);
  }
  throw_if_cancelled(intent.stop);
  const bool is_drawn = !intent.soft.empty();
  if (is_drawn) keep_apart(disk, constrained_start(settled, {{}, intent.soft}), settled);
  settle_apart(target.disk, intent, settled, target.share);
  throw_if_cancelled(intent.stop);
  keep_apart(disk, is_drawn ? translate_to_rest(settled, intent.soft) : align_with(uv, settled),
             settled);
  uv = std::move(settled);
  return true;
}

}  // namespace unwrapd::solve::repair
