#pragma once
// Where a job runs.

#include <memory>
#include <stop_token>

#include "client/arguments.hpp"

namespace unwrapd::server {
class PrivateServer;
}

namespace unwrapd::client {

/// The server that is named; without a name the one at the usual address, or, if there is none, one
/// in this process. `--local`: always that.
class Workplace {
 public:
  /// Throws Failure{file} where there is no room for a server in this process, and
  /// Failure{interrupted}.
  Workplace(const Arguments& arguments, const std::stop_token& stop);
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  ~Workplace();

  /// With the key that it wants.
  [[nodiscard]] const Servers& servers() const { return servers_; }
  [[nodiscard]] bool is_here() const { return own_ != nullptr; }

 private:
  std::unique_ptr<server::PrivateServer> own_;
  Servers servers_;
};

}  // namespace unwrapd::client
