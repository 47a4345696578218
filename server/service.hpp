#pragma once
// The server as a whole, wired by hand: store, queue, workers and HTTP, in the order in which they
// need each other. main() adds the command line and the signals.

#include <memory>
#include <optional>
#include <vector>

#include "server/base/log.hpp"
#include "server/config/config.hpp"
#include "server/http/router.hpp"
#include "server/work/job_worker.hpp"

namespace unwrapd::server {

class Service {
 public:
  /// Opens the data directory, takes up what the last process left, and serves. Throws Error when
  /// the directory is in use, the store cannot be read or the address cannot be had. Without a
  /// program among the functions there is no worker process.
  Service(const config::Config& config, const Log& log,
          const work::WorkerFunctions& functions = {});
  /// Like drain(), without patience.
  ~Service();

  /// 0 of a node that only works.
  [[nodiscard]] int port() const;
  /// Nothing without an admin port.
  [[nodiscard]] std::optional<int> admin_port() const;
  /// Those of the main port: openapi.yaml describes each.
  [[nodiscard]] const std::vector<http::Route>& routes() const;
  /// New jobs are refused, running ones get drain_seconds, then their place in the queue; event
  /// streams end; then nothing is served any more. Call once. False when a job does not stop: the
  /// next start runs it again, but this would not be destroyed before it ends.
  bool drain();
  /// Leaves the jobs that drain() waits for no more time.
  void stop_waiting();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace unwrapd::server
