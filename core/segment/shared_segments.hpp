#pragma once
// Components segmented by several processes (core/base/shared_work.hpp).

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/segment/component_charts.hpp"

namespace unwrapd::segment {

struct ComponentJob {
  const charts::Chart* component;
  ComponentRules rules;
};

/// charts_within_bound() of each, the same whoever makes them. Empty where nobody helps, or the
/// work is too little to share. on_done: called after each job, made here or elsewhere. Throws
/// Error{cancelled}.
std::vector<ComponentCharts> charts_made_together(
    std::span<const ComponentJob> jobs, const std::function<void(std::size_t job)>& on_done,
    Executor& executor);

}  // namespace unwrapd::segment
