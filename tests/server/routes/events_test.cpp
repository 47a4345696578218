// Event streams over HTTP.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "api/events.hpp"
#include "server/access/key_store.hpp"

namespace unwrapd::server::routes {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class Events : public RunningServer {
 protected:
  std::string events(const std::string& id, const httplib::Headers& headers = {}) {
    const auto answer = get(id, "events", headers);
    EXPECT_EQ(answer->get_header_value("Content-Type"), "text/event-stream");
    EXPECT_EQ(answer->get_header_value("X-Accel-Buffering"), "no");
    return answer->body;
  }

  /// A reader that has received its first bytes and stays until the stream ends.
  std::jthread stay(const std::string& id, std::atomic<int>& begun,
                    const httplib::Headers& headers = {}) {
    return std::jthread([this, id, headers, &begun] {
      bool first = true;
      client().Get("/v1/jobs/" + id + "/events", headers, [&](const char*, std::size_t) {
        if (first) ++begun;
        first = false;
        return true;
      });
    });
  }
};

TEST_F(Events, TellTheWholeStoryInOrder) {
  start();
  const std::string id = submit("?stop.iterations=3");
  const std::string story = events(id);
  std::size_t at = 0;
  for (const char* event :
       {"event: queued", "event: started", "\"name\":\"read\"", "\"name\":\"solve\"",
        "event: iteration", "\"i\":3", "\"name\":\"write\"", "event: succeeded"}) {
    at = story.find(event, at);
    ASSERT_NE(at, std::string::npos) << event << " in\n" << story;
  }
  EXPECT_THAT(story, StartsWith("id: 1\n"));
  EXPECT_EQ(state(id), "succeeded");
}

TEST_F(Events, TellEveryNoteOfTheReportBeforeTheEnd) {
  start();
  const std::string id = submit("?compression=draco&lambda=2&output=glb");
  const std::string story = events(id);
  const auto notes = api::Json::parse(get(id, "report")->body).at("notes");
  ASSERT_GE(notes.size(), 2U);
  std::size_t at = story.find("\"name\":\"write\"");
  for (const api::Json& note : notes) {
    at = story.find("event: note\ndata: " + note.dump() + "\n", at);
    ASSERT_NE(at, std::string::npos) << note << " in\n" << story;
  }
  EXPECT_LT(at, story.find("event: succeeded"));
}

TEST_F(Events, OfAnAnswerFromTheStoreTellItsNotes) {
  start();
  const auto send = [&] {
    const auto answer = client().Post("/v1/jobs?compression=draco&lambda=2&output=glb",
                                      {{"Prefer", "wait=60"}}, grid_obj(3), "model/obj");
    return api::Json::parse(answer->body);
  };
  send();
  const api::Json again = send();
  ASSERT_EQ(again.at("attempt"), 0) << "answered from the store";
  const std::string id = again.at("id");
  const auto notes = api::Json::parse(get(id, "report")->body).at("notes");
  ASSERT_GE(notes.size(), 2U);
  std::string story;
  for (std::size_t k = 0; k < notes.size(); ++k)
    story += "id: " + std::to_string(k + 1) + "\nevent: note\ndata: " + notes[k].dump() + "\n\n";
  EXPECT_THAT(events(id), StartsWith(story + "id: " + std::to_string(notes.size() + 1) +
                                     "\nevent: succeeded\n"));
  restart();
  EXPECT_THAT(events(id), StartsWith("id: " + std::to_string(notes.size()) + "\nevent: gap\n"));
}

TEST_F(Events, RefuseParametersThatTheyDoNotKnow) {
  start();
  const std::string id = submit();
  await_state(id, "succeeded");
  for (const std::string path : {"/events", ""})
    expect_problem(client().Get("/v1/jobs/" + id + path + "?lambda=1"), 422, "invalid_option");
  expect_problem(client().Delete("/v1/jobs/" + id + "?lambda=1"), 422, "invalid_option");
  EXPECT_EQ(state(id), "succeeded") << "it is not removed";
}

TEST_F(Events, AreResumedAfterTheLastOneSeen) {
  start();
  const std::string id = submit("?stop.iterations=3");
  const std::string whole = events(id);
  const std::size_t fourth = whole.find("id: 4\n");
  EXPECT_EQ(events(id, {{"Last-Event-ID", "3"}}), whole.substr(fourth));
  const std::string last = whole.substr(whole.rfind("id: "));
  const std::string last_id = last.substr(4, last.find('\n') - 4);
  EXPECT_EQ(events(id, {{"Last-Event-ID", last_id}}), last);
  expect_problem(get(id, "events", {{"Last-Event-ID", "x"}}), 400, "malformed_request");
}

TEST_F(Events, OfALongJobHaveAGapForWhoeverComesLate) {
  start();
  const std::string id = submit("?stop.iterations=5000", 4);
  await_state(id, "succeeded");
  const std::string late = events(id, {{"Last-Event-ID", "2"}});
  EXPECT_THAT(late, HasSubstr("event: gap\ndata: {\"first\":3,"));
  EXPECT_THAT(late, HasSubstr("event: succeeded"));
}

TEST_F(Events, AReaderThatLeavesCancelsNothing) {
  start();
  const std::string id = submit("?stop.iterations=2000", 8);
  client().Get("/v1/jobs/" + id + "/events", [](const char*, std::size_t) { return false; });
  await_state(id, "succeeded");
}

TEST_F(Events, StreamsAreLimitedAndStarveNoOtherRequest) {
  start();
  const std::string id = submit_endless();
  std::atomic<int> begun = 0;
  std::vector<std::jthread> readers;
  for (int r = 0; r < config_.limits.max_streams; ++r) readers.push_back(stay(id, begun));
  await([&] { return begun == config_.limits.max_streams; });
  const auto refused = get(id, "events");
  expect_problem(refused, 503, "too_many_streams");
  EXPECT_TRUE(refused->has_header("Retry-After"));
  EXPECT_EQ(client().Get("/healthz")->status, 200);
  client().Delete("/v1/jobs/" + id);
  readers.clear();
  await([&] { return get(id, "events")->status == 200; });
}

TEST_F(Events, OfOneKeyLeaveHalfOfTheStreamsToOthers) {
  config_.access.require_keys = true;
  start();
  access::KeyStore keys(config_.data, {}, config_.database);
  const auto holder = [&] {
    access::ApiKey key;
    key.scopes = {.submit = true, .read = true};
    return httplib::Headers{{"Authorization", "Bearer " + keys.add(key)}};
  };
  const auto submit_as = [this](const httplib::Headers& key) {
    const auto job =
        client().Post("/v1/jobs?stop.iterations=10000", key, grid_obj(120), "model/obj");
    return api::Json::parse(job->body).at("id").get<std::string>();
  };
  const httplib::Headers greedy = holder(), modest = holder();
  const std::string id = submit_as(greedy), other = submit_as(modest);
  std::atomic<int> begun = 0;
  std::vector<std::jthread> readers;
  const int half = config_.limits.max_streams / 2;
  for (int r = 0; r < half; ++r) readers.push_back(stay(id, begun, greedy));
  await([&] { return begun == half; });
  expect_problem(get(id, "events", greedy), 503, "too_many_streams");
  for (int r = 0; r < half; ++r) readers.push_back(stay(other, begun, modest));
  await([&] { return begun == 2 * half; });
  client().Delete("/v1/jobs/" + id, greedy);
  client().Delete("/v1/jobs/" + other, modest);
}

TEST_F(Events, ThatAreNoLongerKeptAreTold) {
  start();
  const std::string id = submit("?stop.iterations=3");
  await_state(id, "succeeded");
  const std::string all = events(id);
  EXPECT_THAT(all, Not(HasSubstr("event: gap")));
  const std::string last = all.substr(all.rfind("id: "));
  const std::int64_t end = std::stoll(last.substr(4));
  restart();
  const auto gap = [&](std::int64_t first) {
    return api::sse_frame(api::gap_event(first, end - 1));
  };
  EXPECT_EQ(events(id), gap(1) + last);
  EXPECT_EQ(events(id, {{"Last-Event-ID", "2"}}), gap(3) + last);
  for (const std::int64_t seen : {end - 1, end})
    EXPECT_EQ(events(id, {{"Last-Event-ID", std::to_string(seen)}}), last);
}

}  // namespace
}  // namespace unwrapd::server::routes
