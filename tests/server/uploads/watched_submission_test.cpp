// Submissions that are answered with the events of their job.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

namespace unwrapd::server::uploads {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class WatchedSubmission : public RunningServer {
 protected:
  httplib::Result post(httplib::Headers headers = {}, const std::string& query = "") {
    headers.emplace("Accept", "text/event-stream");
    return client().Post("/v1/jobs" + query, headers, grid_obj(4), "model/obj");
  }

  /// A submission that is watched until take() returns false, or the stream ends.
  void watch(int size, const std::function<bool(const std::string& bytes)>& take) {
    httplib::Request request;
    request.method = "POST";
    request.path = "/v1/jobs?stop.iterations=10000";
    request.headers = {{"Accept", "text/event-stream"}, {"Content-Type", "model/obj"}};
    request.body = grid_obj(size);
    request.content_receiver = [&](const char* data, std::size_t count, auto, auto) {
      return take({data, count});
    };
    client().send(request);
  }

  std::size_t job_count() {
    return api::Json::parse(client().Get("/v1/jobs")->body).at("jobs").size();
  }
};

/// The data of the first event of this name.
api::Json data_of(const std::string& story, const std::string& event) {
  const std::string begin = "event: " + event + "\ndata: ";
  const std::size_t at = story.find(begin);
  if (at == std::string::npos) return {};
  const std::size_t data = at + begin.size();
  return api::Json::parse(story.substr(data, story.find('\n', data) - data));
}

TEST_F(WatchedSubmission, TellsTheJobAndThenItsWholeStory) {
  start();
  const auto answer = post({}, "?stop.iterations=3");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->get_header_value("Content-Type"), "text/event-stream");
  EXPECT_EQ(answer->get_header_value("X-Accel-Buffering"), "no");
  EXPECT_THAT(answer->body, StartsWith("event: accepted\n"));
  const api::Json job = data_of(answer->body, "accepted");
  const std::string id = job.at("id");
  EXPECT_EQ(answer->get_header_value("Location"), "/v1/jobs/" + id);
  EXPECT_EQ(job.at("links").at("result"), "/v1/jobs/" + id + "/result");
  const std::string story = answer->body.substr(answer->body.find("\n\n") + 2);
  EXPECT_EQ(story, get(id, "events")->body);
  EXPECT_EQ(data_of(story, "succeeded").at("id"), id);
}

TEST_F(WatchedSubmission, AlsoByAnIdOfTheSenders) {
  start();
  const std::string path = "/v1/jobs/j_0123456789abcdef0123456789abcdef";
  const auto answer =
      client().Put(path, {{"Accept", "text/event-stream"}}, grid_obj(4), "model/obj");
  EXPECT_EQ(answer->get_header_value("Location"), path);
  EXPECT_THAT(answer->body, HasSubstr("event: succeeded"));
}

TEST_F(WatchedSubmission, AReaderThatLeavesCancelsNothing) {
  start();
  std::string head;
  watch(40, [&](const std::string& bytes) {
    head += bytes;
    return head.find("event: started") == std::string::npos;
  });
  const std::string id = data_of(head, "accepted").at("id");
  EXPECT_EQ(state(id), "running");
  client().Delete("/v1/jobs/" + id);
  await_state(id, "cancelled");
}

TEST_F(WatchedSubmission, WithoutAPlaceAmongTheStreamsNothingIsAccepted) {
  start();
  std::atomic<int> begun = 0;
  std::vector<std::jthread> readers;
  const auto stay = [&] {
    bool first = true;
    watch(40, [&](const std::string&) {
      if (std::exchange(first, false)) ++begun;
      return true;
    });
  };
  for (int r = 0; r < config_.limits.max_streams; ++r) readers.emplace_back(stay);
  await([&] { return begun == config_.limits.max_streams; });
  const std::size_t before = job_count();
  const auto refused = post();
  expect_problem(refused, 503, "too_many_streams");
  EXPECT_TRUE(refused->has_header("Retry-After"));
  EXPECT_EQ(job_count(), before);
  EXPECT_EQ(client().Post("/v1/jobs", grid_obj(4), "model/obj")->status, 202);
  const api::Json page = api::Json::parse(client().Get("/v1/jobs")->body);
  for (const api::Json& job : page.at("jobs"))
    client().Delete("/v1/jobs/" + job.at("id").get<std::string>());
  readers.clear();
  await([&] { return post()->status == 200; });
}

TEST_F(WatchedSubmission, OneThatIsRefusedGivesItsPlaceBack) {
  start();
  for (int k = 0; k <= config_.limits.max_streams; ++k)
    expect_problem(post({}, "?method=none"), 422, "invalid_option");
  expect_problem(post({{"Last-Event-ID", "x"}}), 400, "malformed_request");
  EXPECT_EQ(job_count(), 0U);
  EXPECT_EQ(post()->status, 200);
}

TEST_F(WatchedSubmission, SentAgainGoesOnWhereItWas) {
  start();
  const httplib::Headers name = {{"Idempotency-Key", "once"}};
  const std::string whole = post(name)->body;
  const std::string greeting = whole.substr(0, whole.find("\n\n") + 2);
  const auto again = post({{"Idempotency-Key", "once"}, {"Last-Event-ID", "3"}});
  EXPECT_EQ(job_count(), 1U);
  EXPECT_EQ(data_of(again->body, "accepted").at("id"), data_of(greeting, "accepted").at("id"));
  const std::string rest = again->body.substr(again->body.find("\n\n") + 2);
  EXPECT_EQ(rest, whole.substr(whole.find("id: 4\n")));
  restart();  // only the end is remembered
  const std::string late = post(name)->body;
  EXPECT_THAT(late, StartsWith("event: accepted\n"));
  EXPECT_THAT(late, Not(HasSubstr("event: started")));
  EXPECT_EQ(data_of(late, "succeeded"), data_of(whole, "succeeded"));
}

TEST_F(WatchedSubmission, ANewJobIsToldFromItsBeginningWhateverWasSeenOfAnother) {
  start();
  EXPECT_THAT(post({{"Last-Event-ID", "2"}})->body, HasSubstr("\n\nid: 1\nevent: queued"));
}

TEST_F(WatchedSubmission, AnAnswerFromTheStoreIsToldAtOnce) {
  start();
  const std::string first = post()->body;
  const std::string second = post()->body;
  const api::Json job = data_of(second, "accepted");
  EXPECT_NE(job.at("id"), data_of(first, "accepted").at("id"));
  EXPECT_EQ(job.at("state"), "succeeded");
  EXPECT_THAT(second, Not(HasSubstr("event: started")));
  EXPECT_EQ(data_of(second, "succeeded").at("id"), job.at("id"));
}

class Replays : public RunningServer {
 protected:
  Replays() {
    config_.workers = 1;
    config_.limits.max_queue = 1;
    config_.drain_seconds = 100;
  }
  httplib::Result post(const std::string& name, int size) {
    return client().Post("/v1/jobs?stop.iterations=10000", {{"Idempotency-Key", name}},
                         grid_obj(size), "model/obj");
  }
  static std::string id_of(const httplib::Result& answer) {
    return api::Json::parse(answer->body).at("id");
  }
};

TEST_F(Replays, NeedNoPlaceInTheQueue) {
  start();
  const std::string running = id_of(post("one", 120));
  await_state(running, "running");
  const std::string waiting = id_of(post("two", 4));
  expect_problem(post("three", 4), 429, "queue_full");
  EXPECT_EQ(id_of(post("one", 120)), running);
  EXPECT_EQ(id_of(post("two", 4)), waiting);
  expect_problem(post("two", 5), 409, "idempotency_conflict");
  std::jthread drain([&] { service_->drain(); });
  await([&] { return client().Get("/readyz")->status == 503; });
  EXPECT_EQ(id_of(post("one", 120)), running);
  expect_problem(post("three", 4), 503, "draining");
  client().Delete("/v1/jobs/" + running);
}

TEST_F(Replays, OfAnIdAreOfThatIdAlone) {
  start();
  const std::string name = "j_" + std::string(32, 'a');
  static_cast<void>(post(name, 4));
  const auto put =
      client().Put("/v1/jobs/" + name + "?stop.iterations=10000", grid_obj(4), "model/obj");
  expect_problem(put, 409, "idempotency_conflict");
}

}  // namespace
}  // namespace unwrapd::server::uploads
