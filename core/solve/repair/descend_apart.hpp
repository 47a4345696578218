#pragma once
// Lowers the energy of an injective map and keeps it injective.

#include <span>

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/barrier.hpp"

namespace unwrapd::solve::repair {

/// One stage of the descent.
struct ApartStage {
  Barrier barrier;   ///< epsilon must be 0
  double contact;    ///< weight of the barrier between boundaries
  double tolerance;  ///< ends where three steps lower the energy by no more than this share of it
  int most_steps;
  bool may_use_proxy = false;  ///< of SLIM: the symmetric Dirichlet energy, faces weigh their areas
};

/// Lowers the energies of the stages, one after the other. The least value of each is 0, so that a
/// relative fall measures what is left to gain. mesh: the disk's faces with their targets; without
/// soft constraints at least one vertex is fixed. uv must be injective by is_plainly_injective(),
/// and remains so. Throws Error{too_much_memory, cancelled}.
void descend_apart(const Disk& disk, const BarrierMesh& mesh, std::span<const ApartStage> stages,
                   UvMap& uv);

}  // namespace unwrapd::solve::repair
