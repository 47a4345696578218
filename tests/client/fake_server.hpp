#pragma once
// An HTTP server on a free port whose answers a test writes itself.

#include <httplib.h>

#include <string>
#include <thread>

#include "api/job.hpp"

namespace unwrapd::client {

class FakeServer {
 public:
  FakeServer() : port_(server_.bind_to_any_port("127.0.0.1")) {}
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;
  ~FakeServer() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }

  /// To add answers to, before start().
  httplib::Server& routes() { return server_; }

  void start() {
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();  // stop() does nothing before
  }

  [[nodiscard]] std::string address() const { return "http://127.0.0.1:" + std::to_string(port_); }

 private:
  httplib::Server server_;
  int port_;
  std::thread thread_;
};

inline api::Job job_in(api::JobState state) {
  return {.id = "j_1",
          .state = state,
          .created = "2026-01-01T00:00:00Z",
          .attempt = 1,
          .options = api::Json::object(),
          .progress = {},
          .problem = {}};
}

/// Answers with the bytes, but closes the connection after so many of them.
inline void answer_cut_off(httplib::Response& response, std::string bytes, std::size_t after) {
  const std::size_t size = bytes.size();
  response.set_content_provider(
      size, "model/gltf-binary",
      [bytes = std::move(bytes), after](std::size_t from, std::size_t, httplib::DataSink& sink) {
        return from < after && sink.write(bytes.data() + from, after - from);
      });
}

inline void answer(httplib::Response& response, int status, const api::Json& json) {
  response.status = status;
  response.set_content(json.dump(), "application/json");
}

}  // namespace unwrapd::client
