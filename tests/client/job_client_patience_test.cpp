// Which calls a client makes again, and when it gives them up.
#include <gmock/gmock.h>

#include <atomic>

#include "api/error_table.hpp"
#include "client/job_client.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/fake_server.hpp"

namespace unwrapd::client {
namespace {

constexpr Patience kImpatient{.first_pause = std::chrono::milliseconds(1),
                              .longest_pause = std::chrono::milliseconds(2),
                              .lost_connections = 3,
                              .refusals = 2};

JobClient answered_client(const FakeServer& server) {
  const ServerUrl url = parse_server_url(server.address());
  Servers servers(url);
  servers.note_answer(url);
  return JobClient(servers, {}, kImpatient);
}

void answer_all_gets(FakeServer& server, int status, const std::string& body) {
  server.routes().Get(".*", [=](const httplib::Request&, httplib::Response& reply) {
    reply.status = status;
    reply.set_content(body, "text/html");
  });
  server.start();
}

TEST(JobClientPatience, EndsWhereEveryLookAtAJobIsRefused) {
  for (const auto& [status, body] :
       {std::pair<int, const char*>{503, "<html>"}, {200, "hello"}, {500, "<html>"}}) {
    FakeServer server;
    answer_all_gets(server, status, body);
    expect_failure(ExitCode::unreachable,
                   [&] { answered_client(server).follow("j_1", [](const SseEvent&) {}); });
  }
}

TEST(JobClientPatience, OutlastsAnErrorThatIsNotTheServers) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Get("/v1/jobs/j_1/result",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        reply.status = ++asked == 1 ? 500 : 200;
                        reply.set_content(asked == 1 ? "<Error/>" : "bytes", "application/xml");
                      });
  server.start();
  EXPECT_EQ(answered_client(server).fetch("j_1", "/result"), "bytes");
}

TEST(JobClientPatience, TakesAnErrorOfTheServerAtItsWord) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Get("/v1/jobs/j_1/result",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        ++asked;
                        answer(reply, 500, api::problem(Error(ErrorCode::internal, "A fault.")));
                      });
  server.start();
  expect_failure(ExitCode::job_failed, [&] { answered_client(server).fetch("j_1", "/result"); });
  EXPECT_EQ(asked, 1);
}

/// Cut off at four of eight bytes, and then two bytes in all.
TEST(JobClientPatience, NoFileIsMadeOfTwo) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Get("/v1/jobs/j_1/result",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        if (++asked > 1) return reply.set_content("BB", "model/gltf-binary");
                        answer_cut_off(reply, "AAAAAAAA", 4);
                      });
  server.start();
  JobClient client = answered_client(server);
  expect_failure(ExitCode::unreachable,
                 [&] { client.fetch("j_1", "/result", [](std::string_view) {}); });
  asked = 0;
  EXPECT_EQ(client.fetch("j_1", "/result"), "BB") << "text begins anew";
}

/// It cuts each upload off, and other calls are answered meanwhile.
TEST(JobClientPatience, ACallThatAloneGetsNoAnswerFailsAlone) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Get("/v1/jobs/j_1/result",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        ++asked;
                        answer_cut_off(reply, "AAAA", 2);
                      });
  server.start();
  const ServerUrl url = parse_server_url(server.address());
  Servers servers(url);
  servers.note_answer(url);
  Patience endless = kImpatient;
  endless.lost_connections = 1'000'000;
  JobClient client(servers, {}, endless,
                   {.on_begun = {}, .on_wait = [&](const auto&) { servers.note_answer(url); }});
  expect_failure(ExitCode::job_failed, [&] { client.fetch("j_1", "/result"); });
  EXPECT_EQ(asked, 20);
}

/// The answer to the first call is lost; the second would remove what has ended.
TEST(JobClientPatience, NoJobIsRemovedByCancellingItTwice) {
  FakeServer server;
  std::atomic<int> removals = 0;
  server.routes().Delete("/v1/jobs/j_1", [&](const httplib::Request&, httplib::Response& reply) {
    ++removals;
    reply.status = 502;
  });
  server.routes().Get("/v1/jobs/j_1", [&](const httplib::Request&, httplib::Response& reply) {
    answer(reply, 200, to_json(job_in(api::JobState::cancelled)));
  });
  server.start();
  answered_client(server).cancel("j_1");
  EXPECT_EQ(removals, 1);
}

}  // namespace
}  // namespace unwrapd::client
