#include "server/service.hpp"

#include <chrono>
#include <thread>
#include <vector>

#include "server/clock.hpp"
#include "server/data_lock.hpp"
#include "server/http_server.hpp"
#include "server/info_routes.hpp"
#include "server/job_routes.hpp"
#include "server/periodic.hpp"
#include "server/picture_routes.hpp"
#include "server/sweeper.hpp"
#include "server/worker_pool.hpp"

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kHeartbeat{10};
constexpr int kRequestThreads = 64;  // beside those of event streams

HttpConfig http_config(const Config& config) {
  HttpConfig http;
  http.host = config.listen.host;
  http.port = config.listen.port;
  http.max_connections = config.limits.max_streams + kRequestThreads;
  http.limits.max_body_bytes = config.limits.max_body_bytes;
  return http;
}

}  // namespace

struct Service::Parts {
  Parts(const Config& given, const Log& log)
      : config(given),
        lock(config.data),
        blobs(config.data, config.disk),
        store(config.data / "jobs.sqlite"),
        queue(store, blobs, events, log,
              {.max_queue = config.limits.max_queue, .workers = config.workers}),
        streams(events, config.limits.max_streams),
        submissions(queue, blobs, config.limits),
        results(blobs, config.limits),
        sweeper(store, blobs, log, std::chrono::seconds(config.keep_seconds)),
        pictures(blobs, config.limits),
        router(routes(), log),
        http(
            http_config(config), [this](const Request& request) { return router.answer(request); },
            log) {
    queue.recover();
    blobs.sweep([&](const std::string& job) { return store.keeps_files(job); });
    blobs.room().on_shortage([this] { return evict_oldest(store, blobs); });
    sweeping.emplace(
        "sweeping", sweeper.pause(), [this] { sweeper.sweep_once(now_ms(), elapsed_ms()); }, log);
    beating.emplace(
        "prolonging leases", kHeartbeat, [this] { queue.beat(); }, log);
    workers.emplace(queue, blobs, config.limits, log,
                    WorkerConfig{.workers = config.workers,
                                 .threads = config.threads,
                                 .core = &solver_cache});
    serving = std::jthread([this] { http.serve(); });
  }

  std::vector<Route> routes() {
    const JobServices services{store,   queue,       blobs,   events,
                               streams, submissions, results, config.limits};
    std::vector<Route> all;
    add_job_routes(all, services);
    add_unwrap_route(all, services);
    add_picture_routes(all, store, pictures);
    add_info_routes(all, queue, config.limits);
    return all;
  }

  const Config config;
  DataLock lock;
  BlobStore blobs;
  JobStore store;
  EventFeed events;
  JobQueue queue;
  EventStreams streams;
  Submissions submissions;
  ResultStore results;
  Sweeper sweeper;
  PictureStore pictures;
  Router router;
  HttpServer http;
  SolverCache solver_cache{config.memory, config.workers};
  std::optional<Periodic> sweeping;
  std::optional<Periodic> beating;
  std::optional<WorkerPool> workers;
  std::jthread serving;
};

Service::Service(const Config& config, const Log& log)
    : parts_(std::make_unique<Parts>(config, log)) {}

Service::~Service() {
  if (!parts_->serving.joinable()) return;
  parts_->queue.drain(std::chrono::seconds(0));
  parts_->events.end_all();
  parts_->http.stop();
}

int Service::port() const { return parts_->http.port(); }

void Service::drain() {
  parts_->queue.drain(std::chrono::seconds(parts_->config.drain_seconds));
  parts_->events.end_all();
  parts_->http.stop();
  parts_->serving.join();
}

}  // namespace unwrapd::server
