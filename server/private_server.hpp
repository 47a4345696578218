#pragma once
// A server for one process: `unwrap` without a server.

#include <memory>
#include <string>

namespace unwrapd::server {

/// Listens on loopback. It answers only who has its key. Its jobs lie in a temporary folder, which
/// goes with it.
class PrivateServer {
 public:
  /// jobs: that run at once; they share the cores. Throws Error where no temporary folder or no
  /// port can be had.
  explicit PrivateServer(int jobs = 1);
  PrivateServer(const PrivateServer&) = delete;
  PrivateServer& operator=(const PrivateServer&) = delete;
  ~PrivateServer();

  [[nodiscard]] std::string url() const;  ///< "http://127.0.0.1:40123"
  [[nodiscard]] const std::string& key() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace unwrapd::server
