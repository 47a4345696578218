#pragma once
// Where the events and the files of a job at work go: to its feed and its folder, or to the process
// that has both (see job_process.hpp).

#include <string_view>

#include "core/types/progress.hpp"

namespace unwrapd::server::work {

class JobOutput {
 public:
  JobOutput() = default;
  JobOutput(const JobOutput&) = delete;
  JobOutput& operator=(const JobOutput&) = delete;
  virtual ~JobOutput() = default;

  virtual void stage(const StageEvent& event) = 0;
  /// elapsed_ms: since the job began.
  virtual void iteration(const IterationEvent& event, double elapsed_ms) = 0;
  /// The answer's asset. format: glb, gltf or obj.
  virtual void result(std::string_view format, std::string_view bytes) = 0;
  /// A further file of the job's folder.
  virtual void file(std::string_view name, std::string_view bytes) = 0;
};

}  // namespace unwrapd::server::work
