#include "client/servers.hpp"

#include <gmock/gmock.h>

#include <atomic>

#include "api/events.hpp"
#include "client/job_client.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/fake_server.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

using api::JobState;

Servers three() { return Servers(parse_server_urls("a:1,b:1,c:1")); }

TEST(Servers, TakeTurns) {
  Servers servers = three();
  Servers copy = servers;
  std::string origins;
  for (int k = 0; k < 3; ++k) {
    origins += servers.next().origin;
    origins += copy.next().origin;
  }
  EXPECT_EQ(origins, "http://a:1http://b:1http://c:1http://a:1http://b:1http://c:1");
}

TEST(Servers, LeaveOutWhoGaveNoAnswerAMomentAgo) {
  Servers servers = three();
  servers.note_silence(parse_server_url("b:1"));
  for (int k = 0; k < 6; ++k) EXPECT_NE(servers.next().origin, "http://b:1");
  servers.note_answer(parse_server_url("b:1"));
  std::string origins;
  for (int k = 0; k < 3; ++k) origins += servers.next().origin;
  EXPECT_THAT(origins, testing::HasSubstr("http://b:1"));
}

TEST(Servers, TakeAnyWhereNoneAnswers) {
  Servers servers = three();
  for (const char* name : {"a:1", "b:1", "c:1"}) servers.note_silence(parse_server_url(name));
  EXPECT_NE(servers.next().origin, servers.next().origin);
  EXPECT_FALSE(servers.have_answered());
}

constexpr Patience kBrief{.first_pause = std::chrono::milliseconds(1),
                          .longest_pause = std::chrono::milliseconds(2)};

std::string address_of_none() {
  FakeServer gone;
  gone.start();
  return gone.address();
}

TEST(JobClient, GoesOnAtAnotherAddress) {
  FakeServer server;
  server.routes().Post("/v1/jobs", [&](const httplib::Request&, httplib::Response& reply) {
    answer(reply, 202, to_json(job_in(JobState::queued)));
  });
  server.routes().Get("/v1/jobs/j_1/events",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        const api::Event end = api::final_event(3, job_in(JobState::succeeded));
                        reply.set_content(api::sse_frame(end), "text/event-stream");
                      });
  server.start();
  const TemporaryFolder folder;
  const Upload upload = raw_upload(folder.write("mesh.obj", "v"));
  const std::vector<ServerUrl> both = {parse_server_url(address_of_none()),
                                       parse_server_url(server.address())};
  for (int k = 0; k < 3; ++k) {  // though none has ever answered
    JobClient client(Servers(both), {}, kBrief);
    EXPECT_EQ(client.submit(upload, {}).id, "j_1");
    EXPECT_EQ(client.follow("j_1", [](const SseEvent&) {}).state, JobState::succeeded);
  }
}

TEST(JobClient, TriesAnAddressThatNeverAnsweredButOnce) {
  std::atomic<int> waits = 0;
  const Patience endless{.lost_connections = 1'000'000};
  JobClient client(parse_server_url(address_of_none()), {}, endless,
                   {.on_begun = {}, .on_wait = [&](const std::string&) { ++waits; }});
  expect_failure(ExitCode::unreachable, [&] { client.cancel("j_1"); });
  EXPECT_EQ(waits, 0);
}

}  // namespace
}  // namespace unwrapd::client
