#pragma once
// Lowers the method's own energy of an injective map and keeps it injective.

#include <vector>

#include "core/solve/base/disk.hpp"
#include "core/solve/repair/untangle.hpp"

namespace unwrapd::solve::repair {

/// Brings the triangles of a convex map near to their size and shape: lowers the symmetric
/// Dirichlet energy. uv must be injective by is_plainly_injective(), and remains so. share: the
/// weight of each face; empty: its rest area. Throws Error{too_much_memory, cancelled}.
void unfold_apart(const Disk& disk, const std::vector<double>& share, const std::stop_token& stop,
                  UvMap& uv);

/// Lowers the intent's own energy and that of its soft constraints, under a barrier that bounds
/// stretch and one between boundaries. Otherwise as unfold_apart().
void settle_apart(const Disk& disk, const MapIntent& intent, UvMap& uv,
                  const std::vector<double>& share = {});

}  // namespace unwrapd::solve::repair
