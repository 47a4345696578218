#pragma once
// Progress and cancellation are values that a caller passes in; core never looks at a clock.

#include <functional>
#include <optional>
#include <stop_token>

#include "core/mesh/tri_mesh.hpp"

namespace unwrapd {

enum class Stage { read, setup, segment, merge, factor, solve, untangle, measure, pack, write };

/// A stage begins. chart counts from 0; chart_count is 0 while the charts are not yet known.
struct StageEvent {
  Stage stage = Stage::setup;
  Index chart = 0;
  Index chart_count = 0;
  double fraction = 0;                ///< of the whole job, [0, 1], never goes back
  std::optional<double> lambda = {};  ///< of a curve: which of its values
};

/// One local/global iteration is done. The figures are those of the map that it produced.
struct IterationEvent {
  Index chart = 0;
  int iteration = 0;                  ///< counts from 1
  double energy = 0;                  ///< E of the method ÷ surface area (Eq. A2, A3 or 5)
  double rel_change = 0;              ///< (previous energy - energy) / previous energy
  double angle = 2;                   ///< D_angle (Sec. 6)
  double area = 2;                    ///< D_area (Sec. 6)
  Index flipped = 0;                  ///< triangles of negative orientation
  double fraction = 0;                ///< of the whole job, [0, 1]
  std::optional<double> lambda = {};  ///< of a curve: which of its values
};

/// Callbacks are called from the thread that called unwrap(), in order. Empty ones cost nothing.
struct Progress {
  std::function<void(const StageEvent&)> on_stage;
  std::function<void(const IterationEvent&)> on_iteration;
  std::stop_token stop;  ///< honoured within one iteration: unwrap() throws Error{cancelled}
};

}  // namespace unwrapd
