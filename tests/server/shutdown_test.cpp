// The end of a server, and the beginning of the next on the same directory.
#include "running_server.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "core/base/error.hpp"

namespace unwrapd::server {
namespace {

using testing::HasSubstr;
using testing::Not;

class Shutdown : public RunningServer {
 protected:
  /// What a reader of a job's events, there before `act` begins, has seen when they end.
  std::string events_during(const std::string& id, const std::function<void()>& act) {
    std::string seen;
    std::atomic<bool> is_reading = false;
    std::jthread reader([&, client = std::make_shared<httplib::Client>(client())] {
      client->Get("/v1/jobs/" + id + "/events", [&](const char* data, std::size_t size) {
        seen.append(data, size);
        return is_reading = true;
      });
    });
    await([&] { return is_reading.load(); });
    act();
    reader.join();
    return seen;
  }
};

TEST_F(Shutdown, DrainingRefusesJobsAndFinishesThoseThatRun) {
  config_.drain_seconds = 100;
  start();
  EXPECT_EQ(client().Get("/readyz")->status, 200);
  const std::string id = submit_endless();
  await_state(id, "running");
  std::jthread drain([&] { service_->drain(); });
  await([&] { return client().Get("/readyz")->status == 503; });
  const auto refused = client().Post("/v1/jobs", grid_obj(2), "model/obj");
  expect_problem(refused, 503, "draining");
  EXPECT_TRUE(refused->has_header("Retry-After"));
  EXPECT_EQ(client().Get("/healthz")->status, 200);
  EXPECT_EQ(state(id), "running");
  client().Delete("/v1/jobs/" + id);  // so that it ends
  drain.join();
  EXPECT_FALSE(client().Get("/healthz"));
}

TEST_F(Shutdown, AJobThatIsNotDoneInTimeRunsAgainAtTheNextStart) {
  config_.drain_seconds = 0;
  config_.workers = 1;
  start();
  const std::string running = submit_endless();
  const std::string waiting = submit();
  await_state(running, "running");
  const std::string seen = events_during(waiting, [&] { restart(); });
  EXPECT_THAT(seen, Not(HasSubstr("succeeded")));
  await([&] { return job(running).value("attempt", 0) == 2; });
  EXPECT_EQ(state(running), "running");
  EXPECT_EQ(state(waiting), "queued");
  client().Delete("/v1/jobs/" + running);
  await_state(waiting, "succeeded");
}

TEST_F(Shutdown, AnInterruptedJobTellsItsReadersThatItWaits) {
  config_.drain_seconds = 0;
  start();
  const std::string id = submit_endless();
  await_state(id, "running");
  const std::string seen = events_during(id, [&] { service_->drain(); });
  const std::size_t started = seen.find("event: started");
  EXPECT_THAT(seen.substr(std::min(started, seen.size())), HasSubstr("event: queued"));
}

TEST_F(Shutdown, WaitingRequestsAreAnswered) {
  config_.drain_seconds = 0;
  start();
  int status = 0;
  std::jthread sender([&, client = std::make_shared<httplib::Client>(client())] {
    const httplib::Headers wait = {{"Prefer", "wait=60"}};
    client->set_read_timeout(std::chrono::minutes(2));
    status =
        client->Post("/v1/jobs?stop.iterations=10000", wait, grid_obj(120), "model/obj")->status;
  });
  const std::filesystem::path blobs = dir_.path() / "blobs";
  await([&] { return !std::filesystem::is_empty(blobs); });
  await_state(std::filesystem::directory_iterator(blobs)->path().filename(), "running");
  service_->drain();
  sender.join();
  EXPECT_EQ(status, 202);
}

TEST_F(Shutdown, OneDirectoryHasOneServer) {
  start();
  EXPECT_THROW(Service(config_, log_), Error);
}

TEST_F(Shutdown, AnAddressThatIsTakenIsAnError) {
  start();
  config::Config second = config_;
  second.data = dir_.path() / "second";
  second.listen.port = service_->port();
  EXPECT_THROW(Service(second, log_), Error);
}

}  // namespace
}  // namespace unwrapd::server
