#pragma once
// A real server on a free port, in this process, and what its tests send and await.

#include "server/service.hpp"

#include <gtest/gtest.h>
#include <httplib.h>

#include <functional>
#include <memory>
#include <string>

#include "api/json.hpp"
#include "temp_dir.hpp"

namespace unwrapd::server {

/// An OBJ of a bumpy square of size x size quads.
std::string grid_obj(int size);
/// The same as a .gltf whose buffer is grid.bin, and that buffer.
std::string grid_gltf(int size);
std::string grid_buffer(int size);
/// The same as one GLB.
std::string grid_glb(int size);

/// Waits for a condition that other threads bring about; fails the test when it never comes.
void await(const std::function<bool()>& condition);

class RunningServer : public testing::Test {
 protected:
  RunningServer();

  void start();
  /// Ends the server as SIGTERM does and starts another on the same directory.
  void restart();
  [[nodiscard]] httplib::Client client() const;

  /// Sends an OBJ; the answer must be a job. Returns its id. Without a preset in the query it stays
  /// one chart, which takes least time.
  std::string submit(const std::string& query = "", int size = 4);
  /// A job that goes on until it is stopped.
  std::string submit_endless() { return submit("?stop.iterations=10000", 120); }
  api::Json job(const std::string& id);
  std::string state(const std::string& id) { return job(id).at("state"); }
  void await_state(const std::string& id, const std::string& expected);
  httplib::Result get(const std::string& id, const std::string& what,
                      const httplib::Headers& headers = {});

  TempDir dir_;
  config::Config config_;
  Log log_{LogLevel::off};
  std::unique_ptr<Service> service_;
};

/// Expects a problem document of this status and code.
void expect_problem(const httplib::Result& answer, int status, const std::string& code);

}  // namespace unwrapd::server
