#pragma once
// The work on meshes that a worker process does for its server; the functions of run_job.hpp and
// rendering.hpp, but in tests.

#include <functional>
#include <string>

#include "server/work/rendering.hpp"
#include "server/work/run_job.hpp"

namespace unwrapd::server::work {

struct WorkerFunctions {
  std::function<std::string(const JobTask&, const asset::Input&, JobOutput&, const api::Limits&,
                            Executor&)>
      run = run_job;
  std::function<std::string(const Rendering&, const RenderingInput&, const api::Limits&)> draw =
      render;
  std::string program = {};  ///< that does them, given --job-worker; empty: there is none
};

}  // namespace unwrapd::server::work
