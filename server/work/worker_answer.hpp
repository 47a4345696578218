#pragma once
// Checks what a worker process answers. A hostile mesh may have taken the process over, so its
// answer is limited to what some job could have answered.

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "server/work/job_frames.hpp"

namespace unwrapd::server::work {

/// Whether work on a mesh can end with this error. Others are the server's own to tell: of its
/// store, its queue, its keys.
[[nodiscard]] bool is_of_work(ErrorCode code);

/// The failure that a worker reports.
struct ToldFailure {
  Error error;
  std::string reason;  ///< of an exception that nobody foresaw: for the log alone; else empty
};

/// The failure of a frame. Throws Error{internal} if work on a mesh cannot end with it.
ToldFailure failure_told(const Frame& frame);

/// "glb", "gltf" or "obj".
[[nodiscard]] bool is_result_format(std::string_view name);

/// The files of a job's answer, each of which comes once: of every map its UVs and its report, the
/// totals, the result.
class AnswerFiles {
 public:
  /// maps: how many the job has (lambda_selection.hpp).
  explicit AnswerFiles(std::size_t maps);

  /// Whether a file of this name may come now. It may not come again.
  [[nodiscard]] bool take(std::string_view name);
  /// The same for the result, in whatever format.
  [[nodiscard]] bool take_result(std::string_view format);

 private:
  std::set<std::string, std::less<>> left_;
  bool has_result_ = false;
};

}  // namespace unwrapd::server::work
