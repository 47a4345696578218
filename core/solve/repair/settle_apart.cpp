// The energy of ARAP bears a triangle that is pressed flat, and one spike has many: under the wall
// itself, as it fades, the worst stretch of Cow is 12. The fourth power of the wall bounds it at
// no cost elsewhere.
#include "core/solve/repair/settle_apart.hpp"

#include <utility>

#include "core/solve/repair/descend_apart.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr ApartStage kUnfolding{
    .barrier = {.rigidity = {}, .weight = 0, .own = OwnEnergy::symmetric_dirichlet},
    .contact = 1,
    .tolerance = 0.02,
    .most_steps = 300,
    .may_use_proxy = true};

constexpr ApartStage kIsometric{
    .barrier = {.rigidity = {}, .weight = 0, .own = OwnEnergy::symmetric_dirichlet},
    .contact = 1e-2,
    .tolerance = 1e-3,
    .most_steps = 100};

/// The wall alone determines sizes.
constexpr ApartStage kAngles{.barrier = {.rigidity = {}, .weight = 1e-2, .own = OwnEnergy::mips},
                             .contact = 1e-3,
                             .tolerance = 1e-3,
                             .most_steps = 100};

ApartStage last_stage(const MapIntent& intent) {
  switch (intent.own) {
    case OwnEnergy::symmetric_dirichlet:
      return kIsometric;
    case OwnEnergy::mips:
      return kAngles;
    default:
      return {.barrier = {.rigidity = intent.rigidity, .weight = 0, .steep = 1e-3},
              .contact = 1e-4,
              .tolerance = 3e-4,
              .most_steps = 100};
  }
}

/// All vertices are free, but for one if nothing else determines the translation.
BarrierMesh loose(const Disk& disk, const std::vector<double>& share,
                  const std::vector<SoftConstraint>& soft, const std::stop_token& stop) {
  std::vector<char> hard(disk.positions.size(), 0);
  hard.front() = soft.empty() ? 1 : 0;
  return {{disk.faces.begin(), disk.faces.end()},
          {disk.rest.begin(), disk.rest.end()},
          linear::number_free(hard),
          soft,
          stop,
          share};
}

}  // namespace

void unfold_apart(const Disk& disk, const std::vector<double>& share, const std::stop_token& stop,
                  UvMap& uv) {
  ApartStage stage = kUnfolding;
  stage.may_use_proxy = share.empty();
  descend_apart(disk, loose(disk, share, {}, stop), {&stage, 1}, uv);
}

void settle_apart(const Disk& disk, const MapIntent& intent, UvMap& uv,
                  const std::vector<double>& share) {
  const ApartStage stage = last_stage(intent);
  descend_apart(disk, loose(disk, share, intent.soft, intent.stop), {&stage, 1}, uv);
}

}  // namespace unwrapd::solve::repair
