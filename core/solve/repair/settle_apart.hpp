#pragma once
// An injective map taken to little energy of a method's own, and kept injective.

#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// From a convex map to one whose triangles are about of their size and shape: lowers the symmetric
/// Dirichlet energy. uv must be injective by is_plainly_injective(), and still is afterwards.
/// share: what each face weighs, instead of its rest area; empty: that. Throws
/// Error{too_much_memory, cancelled}.
void unfold_apart(const Disk& disk, const std::vector<double>& share, const std::stop_token& stop,
                  UvMap& uv);

/// Lowers the intent's own energy and that of its soft constraints under a barrier that bounds how
/// much a triangle is stretched, and one between boundaries. As unfold_apart() otherwise.
void settle_apart(const Disk& disk, const MapIntent& intent, UvMap& uv,
                  const std::vector<double>& share = {});

}  // namespace unwrapd::solve::repair
