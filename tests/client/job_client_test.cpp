// The client against a server that behaves badly on purpose.
#include "client/job_client.hpp"

#include <gmock/gmock.h>

#include <atomic>

#include "api/error_table.hpp"
#include "api/events.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/fake_server.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

using api::JobState;
using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr Patience kHasty{.first_pause = milliseconds(1),
                          .longest_pause = milliseconds(2),
                          .lost_connections = 3,
                          .refusals = 3};

JobClient client_of(const FakeServer& server, std::stop_token stop = {}) {
  return JobClient(parse_server_url(server.address()), std::move(stop), kHasty);
}

const char* const kEvents = "/v1/jobs/j_1/events";

void send_frames(httplib::Response& response, const std::vector<api::Event>& events) {
  std::string text;
  for (const api::Event& event : events) text += api::sse_frame(event);
  response.set_content(text, "text/event-stream");
}

TEST(JobClient, SubmitsTheBytesWithTheOptionsInTheQuery) {
  FakeServer server;
  std::string seen, type, method;
  server.routes().Post("/v1/jobs", [&](const httplib::Request& request, httplib::Response& reply) {
    seen = request.body;
    type = request.get_header_value("Content-Type");
    method = request.get_param_value("method") + "&" + request.get_param_value("odd name");
    answer(reply, 202, to_json(job_in(JobState::queued)));
  });
  server.start();
  const TemporaryFolder folder;
  const std::string bytes(300'000, 'b');
  const Upload upload = raw_upload(folder.write("mesh.obj", bytes));
  const api::Job job =
      client_of(server).submit(upload, {{"method", "asap"}, {"odd name", "a&b=c"}});
  EXPECT_EQ(job.id, "j_1");
  EXPECT_EQ(seen, bytes);
  EXPECT_EQ(type, "model/obj");
  EXPECT_EQ(method, "asap&a&b=c");
}

TEST(JobClient, ShowsTheServersProblem) {
  FakeServer server;
  server.routes().Post("/v1/jobs", [&](const httplib::Request&, httplib::Response& reply) {
    const Error error(ErrorCode::invalid_option, "iterations must be lower.", "/stop/iterations");
    answer(reply, 422, api::problem(error));
  });
  server.start();
  const TemporaryFolder folder;
  const Upload upload = raw_upload(folder.write("mesh.obj", "v"));
  const std::string message =
      expect_failure(ExitCode::job_failed, [&] { client_of(server).submit(upload, {}); });
  for (const char* part : {"iterations must be lower.", "invalid_option", "/stop/iterations"})
    EXPECT_THAT(message, HasSubstr(part));
}

TEST(JobClient, TellsAnotherServiceFromUnwrapd) {
  FakeServer server;
  server.routes().Post("/v1/jobs", [&](const httplib::Request&, httplib::Response& reply) {
    reply.set_content("<html>", "text/html");
  });
  server.start();
  const TemporaryFolder folder;
  const Upload upload = raw_upload(folder.write("mesh.obj", "v"));
  expect_failure(ExitCode::unreachable, [&] { client_of(server).submit(upload, {}); });
  expect_failure(ExitCode::unreachable, [&] { client_of(server).fetch("j_1", "/report"); });
}

TEST(JobClient, TakesALostStreamUpAgainBehindTheLastEvent) {
  FakeServer server;
  std::vector<std::string> asked;
  server.routes().Get(kEvents, [&](const httplib::Request& request, httplib::Response& reply) {
    asked.push_back(request.get_header_value("Last-Event-ID"));
    if (asked.size() == 1) {
      send_frames(reply, {api::queued_event(1, 0), api::started_event(2, 1)});
    } else {
      send_frames(reply, {api::final_event(3, job_in(JobState::succeeded))});
    }
  });
  server.routes().Get("/v1/jobs/j_1", [&](const httplib::Request&, httplib::Response& reply) {
    answer(reply, 200, to_json(job_in(JobState::running)));
  });
  server.start();
  std::vector<std::string> names;
  const api::Job job =
      client_of(server).follow("j_1", [&](const SseEvent& event) { names.push_back(event.name); });
  EXPECT_EQ(job.state, JobState::succeeded);
  EXPECT_THAT(asked, testing::ElementsAre("", "2"));
  EXPECT_THAT(names, testing::ElementsAre("queued", "started", "succeeded"));
}

TEST(JobClient, AsksForTheStateWhenThereIsNoStreamToBeHad) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Get(kEvents, [&](const httplib::Request&, httplib::Response& reply) {
    answer(reply, 503, api::problem(Error(ErrorCode::too_many_streams, "Too many.")));
  });
  server.routes().Get("/v1/jobs/j_1", [&](const httplib::Request&, httplib::Response& reply) {
    answer(reply, 200, to_json(job_in(++asked < 8 ? JobState::running : JobState::cancelled)));
  });
  server.start();
  EXPECT_EQ(client_of(server).follow("j_1", [](const SseEvent&) {}).state, JobState::cancelled);
  EXPECT_EQ(asked, 8);
}

TEST(JobClient, GivesUpOnAServerThatStaysAway) {
  std::string address;
  {
    FakeServer gone;
    gone.start();
    address = gone.address();
  }
  JobClient client(parse_server_url(address), {}, kHasty);
  const std::string message =
      expect_failure(ExitCode::unreachable, [&] { client.follow("j_1", [](const SseEvent&) {}); });
  EXPECT_THAT(message, HasSubstr("--server"));
}

TEST(JobClient, ComesBackWhenTheQueueWasFull) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Post("/v1/jobs", [&](const httplib::Request&, httplib::Response& reply) {
    if (++asked == 2) return answer(reply, 202, to_json(job_in(JobState::queued)));
    reply.set_header("Retry-After", "1");
    answer(reply, 429, api::problem(Error(ErrorCode::queue_full, "The queue is full.")));
  });
  server.start();
  const TemporaryFolder folder;
  const Upload upload = raw_upload(folder.write("mesh.obj", "v"));
  EXPECT_EQ(client_of(server).submit(upload, {}).id, "j_1");
  EXPECT_EQ(asked, 2);
}

/// A server that has answered before, so that calls to it are made again.
Servers known(const FakeServer& server) {
  const ServerUrl url = parse_server_url(server.address());
  Servers servers(url);
  servers.note_answer(url);
  return servers;
}

TEST(JobClient, SendsAJobAgainUnderTheSameNameWhenTheAnswerIsLost) {
  FakeServer server;
  std::vector<std::string> names, bodies;
  server.routes().Post("/v1/jobs", [&](const httplib::Request& request, httplib::Response& reply) {
    names.push_back(request.get_header_value("Idempotency-Key"));
    bodies.push_back(request.body);
    if (names.size() % 2 == 0) return answer(reply, 202, to_json(job_in(JobState::queued)));
    reply.status = 502;  // as of a proxy whose server died
    reply.set_content("<html>", "text/html");
  });
  server.start();
  const TemporaryFolder folder;
  const Upload upload = raw_upload(folder.write("mesh.obj", "v 1"));
  JobClient client(known(server), {}, kHasty);
  EXPECT_EQ(client.submit(upload, {}).id, "j_1");
  EXPECT_EQ(client.submit(upload, {}).id, "j_1");
  ASSERT_EQ(names.size(), 4U);
  EXPECT_GE(names[0].size(), 32U);
  EXPECT_EQ(names[1], names[0]);
  EXPECT_NE(names[2], names[0]);
  EXPECT_EQ(names[3], names[2]);
  EXPECT_THAT(bodies, testing::Each("v 1"));
}

TEST(JobClient, PassesOnEachByteOfAnAnswerThatIsCutOffOnce) {
  FakeServer server;
  std::string all(200'000, 'r');
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>('a' + i % 23);
  std::atomic<std::size_t> asked = 0;
  server.routes().Get("/v1/jobs/j_1/result",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        ++asked;
                        answer_cut_off(reply, all, asked < 3 ? 70'000 * asked : all.size());
                      });
  server.start();
  std::string received;
  JobClient client(known(server), {}, kHasty);
  client.fetch("j_1", "/result", [&](std::string_view bytes) { received += bytes; });
  EXPECT_EQ(received, all);
  EXPECT_EQ(asked, 3U);
}

TEST(JobClient, WaitsForABusyServerWhateverItAsks) {
  FakeServer server;
  std::atomic<int> asked = 0;
  server.routes().Get(
      "/v1/jobs/j_1/report", [&](const httplib::Request&, httplib::Response& reply) {
        if (++asked > 1) return reply.set_content("{}", "application/json");
        reply.set_header("Retry-After", "1");
        answer(reply, 429, api::problem(Error(ErrorCode::rate_limited, "Too many requests.")));
      });
  server.start();
  std::vector<std::string> told;
  JobClient client(
      parse_server_url(server.address()), {}, kHasty,
      {.on_begun = {}, .on_wait = [&](const std::string& why) { told.push_back(why); }});
  EXPECT_EQ(client.fetch("j_1", "/report"), "{}");
  EXPECT_EQ(told.size(), 1U);
}

TEST(JobClient, TellsOnceThatTheJobHasBegun) {
  FakeServer server;
  server.routes().Get(kEvents, [&](const httplib::Request&, httplib::Response& reply) {
    send_frames(reply, {api::queued_event(1, 0), api::started_event(2, 1),
                        api::final_event(3, job_in(JobState::succeeded))});
  });
  server.start();
  int begun = 0, events = 0, events_before = 0;
  JobClient client(parse_server_url(server.address()), {}, kHasty,
                   {.on_begun = [&] { ++begun, events_before = events; }, .on_wait = {}});
  client.follow("j_1", [&](const SseEvent&) { ++events; });
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(events_before, 1);
}

TEST(JobClient, StopsInTheMiddleOfAWaitForTheNextEvent) {
  std::stop_source stop;  // outlives the server, whose thread asks it
  FakeServer server;
  server.routes().Get(kEvents, [&](const httplib::Request&, httplib::Response& reply) {
    reply.set_chunked_content_provider("text/event-stream", [&](std::size_t, auto& sink) {
      const std::string frame = api::sse_frame(api::started_event(1, 1));
      return !stop.stop_requested() && sink.write(frame.data(), frame.size());
    });
  });
  server.start();
  JobClient client = client_of(server, stop.get_token());
  expect_failure(ExitCode::interrupted,
                 [&] { client.follow("j_1", [&](const SseEvent&) { stop.request_stop(); }); });
}

TEST(JobClient, AFailingSinkEndsTheDownload) {
  FakeServer server;
  server.routes().Get("/v1/jobs/j_1/result",
                      [&](const httplib::Request&, httplib::Response& reply) {
                        reply.set_content("bytes", "model/gltf-binary");
                      });
  server.start();
  expect_failure(ExitCode::file, [&] {
    client_of(server).fetch("j_1", "/result", [](std::string_view) {
      throw Failure(ExitCode::file, "The disk is full.");
    });
  });
}

TEST(JobClient, NeverHandsARefusalToTheSink) {
  FakeServer server;
  server.routes().Get(
      "/v1/jobs/j_1/result", [&](const httplib::Request&, httplib::Response& reply) {
        answer(reply, 410, api::problem(Error(ErrorCode::result_expired, "It is gone.")));
      });
  server.start();
  const std::string message = expect_failure(ExitCode::job_failed, [&] {
    client_of(server).fetch("j_1", "/result", [](std::string_view) { ADD_FAILURE(); });
  });
  EXPECT_THAT(message, HasSubstr("result_expired"));
}

}  // namespace
}  // namespace unwrapd::client
