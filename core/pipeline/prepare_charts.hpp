#pragma once
// What a job knows before anything is solved: the charts of its surfaces, and all that follows from
// surfaces and charts alone. Jobs on the same surfaces share it.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/executor.hpp"
#include "core/charts/charts.hpp"
#include "core/pack/pack.hpp"
#include "core/pipeline/assemble.hpp"
#include "core/solve/base/disk.hpp"
#include "core/types/note.hpp"
#include "core/types/progress.hpp"

namespace unwrapd::pipeline {

/// Nothing in here changes once it is made; disks are views of the charts beside them.
struct Prepared {
  std::vector<charts::Charts> surfaces;                  ///< one a surface; every chart a disk
  std::vector<std::vector<solve::Disk>> disks;           ///< disks[s][k]: of chart k of surface s
  std::vector<std::shared_ptr<const VertexPlan>> plans;  ///< one a surface: all charts are whole
  std::optional<Note> note;                              ///< what the report says of the charts

  Prepared() = default;
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;
};

/// Bytes that keeping it takes.
std::size_t bytes_of(const Prepared& prepared);

struct PreparedCharts {
  std::shared_ptr<const Prepared> all;
  double solve_begin;  ///< the share of this job that is behind it
};

/// From surfaces to charts, made or found at the executor's core: progress is told only of what is
/// made. Throws Error{no_triangles, not_orientable, invalid_option, zero_area, too_much_memory,
/// cancelled}.
PreparedCharts prepare_charts(std::span<const Surface> surfaces, const UnwrapOptions& options,
                              const Progress& progress, Executor& executor);

}  // namespace unwrapd::pipeline
