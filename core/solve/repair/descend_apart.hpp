#pragma once
// An injective map taken to less energy, and kept injective.

#include <span>

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/barrier.hpp"

namespace unwrapd::solve::repair {

/// One stage of the way down.
struct ApartStage {
  Barrier barrier;   ///< epsilon must be 0
  double contact;    ///< weight of the barrier between boundaries
  double tolerance;  ///< ends where three steps lower the energy by no more than this share of it
  int most_steps;
  bool may_use_proxy = false;  ///< of SLIM: the symmetric Dirichlet energy, faces weigh their areas
};

/// Lowers the energies of the stages, one after the other. All of them are 0 at their least, so
/// that a share of one is a share of what may be to gain. mesh: the disk's faces with what they
/// shall be; without soft constraints at least one vertex is fixed. uv must be injective by
/// is_plainly_injective(), and still is afterwards. Throws Error{too_much_memory, cancelled}.
void descend_apart(const Disk& disk, const BarrierMesh& mesh, std::span<const ApartStage> stages,
                   UvMap& uv);

}  // namespace unwrapd::solve::repair
