#pragma once
// Where the processes of a job that several work on exchange bundles (core/base/shared_work.hpp).
// The server has the desk, each worker process asks for what it needs through its socket.

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::server::work {

/// Stages are known by 64 hex digits. For one thread.
class WorkDesk {
 public:
  struct Claim {
    int bundle = 0;
    std::optional<std::string> made = {};  ///< what a process has made of it that is gone
  };

  WorkDesk() = default;
  WorkDesk(const WorkDesk&) = delete;
  WorkDesk& operator=(const WorkDesk&) = delete;
  virtual ~WorkDesk() = default;

  /// A bundle that no process has begun; none: all were begun, or it cannot be told. All throw
  /// Error{cancelled} where a helper shall help no longer.
  virtual std::optional<Claim> claim(std::string_view stage, int bundles) = 0;
  virtual void publish(std::string_view stage, int bundle, std::string_view bytes) = 0;
  /// A bundle that another process has begun, waiting for it; none: not within this time. A helper
  /// waits as long as its job runs.
  virtual std::optional<std::string> obtain(std::string_view stage, int bundle,
                                            std::chrono::milliseconds patience) = 0;
};

}  // namespace unwrapd::server::work
