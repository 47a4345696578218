// Slow clients: what they may hold of a server, and that they get what they are sent.
#include <gtest/gtest.h>

#include <array>
#include <list>
#include <thread>
#include <vector>

#include "tests/server/raw_client.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::http {
namespace {

class SlowClients : public RunningServer {
 protected:
  SlowClients() { config_.edge.max_requests = 4; }
};

TEST_F(SlowClients, ThatNeverReadDoNotHoldAllThreads) {
  start();
  std::string many;
  for (int k = 0; k < 300; ++k) many += "GET /openapi.json HTTP/1.1\r\nHost: x\r\n\r\n";
  std::list<RawClient> deaf;
  for (int k = 0; k < 4; ++k) deaf.emplace_back(service_->port()).send(many);
  for (int k = 0; k < 10; ++k) {
    httplib::Client other = client();
    other.set_read_timeout(std::chrono::seconds(8));  // less than one of them is waited for
    EXPECT_TRUE(other.Get("/healthz")) << k;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

TEST_F(SlowClients, ThatReadGetAllThatTheyAskedFor) {
  start();
  const std::size_t each = client().Get("/openapi.json")->body.size();
  std::string many;
  for (int k = 0; k < 100; ++k) many += "GET /openapi.json HTTP/1.1\r\nHost: x\r\n\r\n";
  std::array<std::size_t, 4> got{};
  std::vector<std::jthread> readers;
  for (std::size_t& bytes : got)
    readers.emplace_back([&] {
      const RawClient raw(service_->port());
      raw.send(many);
      std::array<char, 65'536> piece;
      while (bytes < 100 * each) {
        const std::size_t came = raw.receive(piece.data(), piece.size());
        if (came == 0) return;
        bytes += came;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
  readers.clear();
  for (const std::size_t bytes : got) EXPECT_GE(bytes, 100 * each);
}

TEST_F(SlowClients, ThatSendDoNotHoldAllThreads) {
  start();
  std::list<RawClient> slow;
  for (int k = 0; k < 4; ++k)
    slow.emplace_back(service_->port())
        .send("POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Length: 9000\r\n\r\nv 0 0 0");
  for (int k = 0; k < 10; ++k) {
    httplib::Client other = client();
    other.set_read_timeout(std::chrono::seconds(10));  // less than one of them is waited for
    EXPECT_TRUE(other.Get("/healthz")) << k;
  }
}

/// Twice as many as the admin port has places (64), each with half a head.
std::list<RawClient> too_many_idle(int port) {
  std::list<RawClient> idle;
  for (int k = 0; k < 128; ++k) idle.emplace_back(port).send("GET /healthz HTTP/1.1\r\nHo");
  return idle;
}

TEST_F(SlowClients, OfOnePortTakeNoPlaceOfTheOther) {
  config_.admin = http::Address{"127.0.0.1", 0};
  config_.edge.max_connections = 64;
  start();
  const auto answers = [](int port, const char* path) {
    httplib::Client other("127.0.0.1", port);
    other.set_read_timeout(std::chrono::seconds(4));  // less than half a head is waited for
    const auto answer = other.Get(path);
    return answer && answer->status == 200;
  };
  {
    const std::list<RawClient> of_admin = too_many_idle(*service_->admin_port());
    EXPECT_TRUE(answers(service_->port(), "/healthz")) << "the other port";
    EXPECT_TRUE(answers(*service_->admin_port(), "/readyz")) << "its own: the idle have 48 places";
    await_state(submit(), "succeeded");
  }
  const std::list<RawClient> of_edge = too_many_idle(service_->port());
  EXPECT_TRUE(answers(*service_->admin_port(), "/healthz"));
  EXPECT_TRUE(answers(*service_->admin_port(), "/metrics"));
}

}  // namespace
}  // namespace unwrapd::server::http
