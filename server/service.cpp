#include "server/service.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/base/threads.hpp"
#include "server/config/component_config.hpp"
#include "server/http/access_log.hpp"
#include "server/http/sites.hpp"
#include "server/jobs/worker_pool.hpp"
#include "server/other_nodes.hpp"
#include "server/routes/admin_routes.hpp"
#include "server/routes/info_routes.hpp"
#include "server/routes/job_routes.hpp"
#include "server/routes/link_routes.hpp"
#include "server/routes/mesh_routes.hpp"
#include "server/routes/picture_routes.hpp"
#include "server/service_metrics.hpp"
#include "server/store/data_directory.hpp"
#include "server/store/sweeper.hpp"
#include "server/webhooks/webhooks.hpp"

namespace unwrapd::server {
namespace {

using namespace std::chrono_literals;
constexpr int kBeatsInALease = 3;
constexpr std::size_t kEventsKept = 1024, kFeedsKept = 64;  // of each job; of finished jobs

}  // namespace

struct Service::Parts {
  Parts(const config::Config& given, const Log& log, const work::WorkerFunctions& functions)
      : config(given),
        isolation(config::isolation_of(config, solver_cache, functions)),
        lock(config.data),
        node(node_of(config)),
        blobs(blobs_of(config, node, log)),
        store(store::store_in(config.data, database_of(config, node), blobs), read_clocks, node),
        mesh_store(other_rows),
        queue(store, blobs, events, log,
              {.max_queue = config.limits.max_queue,
               .workers = config.workers,
               .max_stored = config.max_stored_jobs,
               .lease = config.lease,
               .stop = config::most_stopping(config)}),
        streams(events, config.limits.max_streams),
        keys(keys_of(config, other_rows)),
        links(secret),
        access(keys, links, access::asks_for_keys(config.access, config.listen.host)),
        cors(config.cors_origins),
        sites(config.allowed_hosts, cors),
        webhooks(
            other_rows, secret, config.webhooks, log, [this] { return store.now(); },
            node.is_shared),
        renderer(blobs, config.limits, log, isolation,
                 config::render_limits(config, solver_cache.memory_limit()), functions),
        meshes(mesh_store, store, blobs, rooms, renderer),
        sources(config.sources, config.limits.max_body_bytes, log, metrics),
        submissions(queue, store, blobs, config.limits, config.webhooks, meshes, sources, rooms),
        results(blobs, renderer, config::results_from(config)),
        sweeper(store, mesh_store, blobs, log, std::chrono::seconds(config.keep_seconds)),
        pictures(blobs, renderer),
        router(routes(), log,
               [this](http::Request& request, std::string_view route) {
                 access.admit(request, route);
               }),
        admin_router(routes::admin_routes(readiness, metrics), log) {
    if (config.serves) http.emplace(config::http_config(config), main_uses(log), log);
    if (config.admin) {
      const bool only_here = !access::asks_for_keys({}, config.admin->host);
      const auto told = [this, only_here](const http::Request& request) {
        const auto refused = only_here ? sites.refusal(request) : std::nullopt;  // pages' calls
        return refused ? http::error_response(*refused) : admin_router.answer(request);
      };
      admin.emplace(config::admin_config(*config.admin), uses(told, log, LogLevel::debug), log);
    }
    config::warn_without_keys(config, keys.has_any(), log);
    other_nodes.emplace(config.database, store, blobs, events, queue, log);
    tell_state();
    config::tell_isolation(isolation, config, log, metrics);
    queue.recover(isolation.possible);
    if (!node.is_shared) store::sweep_at_start(store, mesh_store, blobs, log);
    blobs.room().on_shortage(
        {.evict = [this] { return store::evict_oldest(store, mesh_store, blobs); },
         .bytes = [this] { return store.evictable_bytes() + blobs.lost().bytes(); },
         .give_up_lost = [this] { return blobs.give_up_copy() || blobs.lost().give_up_first(); }});
    blobs.on_keeping({.reservation = [this](const auto& id, auto seq,
                                            auto bytes) { return claim_to_keep(id, seq, bytes); },
                      .kept =
                          [this](std::string_view id, std::int64_t bytes) {
                            is_mesh_id(id) ? mesh_store.set_stored_bytes(id, bytes)
                                           : store.set_stored_bytes(id, bytes);
                          }});
    start_periodic(log);
    workers.emplace(
        queue, blobs, config.limits, log,
        jobs::WorkerConfig{.workers = config.workers,
                           .threads = config.threads,
                           .core = &solver_cache,
                           .reservations = &reservations,
                           .most_bytes = [this](const auto& id) { return most_bytes(id); },
                           .isolation = isolation,
                           .functions = functions,
                           .on_force =
                               [this](std::string_view how) {
                                 metrics.count(Metric::jobs_forced, {{"ended", how}});
                               }});
    metrics.tell(Metric::lost_threads, {}, [this] { return workers->lost(); });
    if (http) serving = std::jthread([this] { http->serve(); });
    if (admin) serving_admin = std::jthread([this] { admin->serve(); });
  }

  /// The quota of an owner in bytes; 0: none.
  std::int64_t most_bytes(const std::string& owner) {
    const std::optional<access::ApiKey> key = keys.with_id(owner);
    return key ? key->quota.max_bytes : 0;
  }

  /// Reserves bytes in the quota of the job's owner, if it allows them. The analysis of a mesh is
  /// short and not counted.
  std::shared_ptr<void> claim_to_keep(const std::string& id, std::int64_t seq, std::int64_t bytes) {
    const std::optional<store::JobRecord> job = store.find(id);
    if (job ? job->seq != seq : !is_mesh_id(id)) return nullptr;
    auto reservation =
        std::make_shared<store::QuotaReservation>(reservations, job ? job->owner : std::string());
    if (job && !reservation->try_set(bytes, most_bytes(job->owner))) return nullptr;
    return reservation;
  }

  http::HttpUses main_uses(const Log& log) {
    http::HttpUses all =
        uses([this](const http::Request& request) { return answer(request); }, log, LogLevel::info);
    all.news = news;
    return all;
  }

  http::HttpUses uses(http::Handler answer_one, const Log& log, LogLevel level) {
    return {.answer = std::move(answer_one),
            .observe =
                [this, &log, level](const http::Exchanged& done) {
                  http::log_request(done, log, level, metrics);
                },
            .trusted_proxies = http::AddressSet(config.edge.trusted_proxies)};
  }

  http::Response answer(const http::Request& request) const {
    if (!access::asks_for_keys(config.access, config.listen.host))
      if (const std::optional<Error> refused = sites.refusal(request))
        return http::error_response(*refused);
    std::optional<http::Response> early = cors.preflight(request);
    http::Response response = early ? std::move(*early) : router.answer(request);
    cors.allow(request, response);
    return response;
  }

  void start_periodic(const Log& log) {
    sweeping.emplace(
        "sweeping", sweeper.pause(),
        [this] {
          sweeper.sweep_once();
          blobs.trim_copies();
          blobs.remove_left();
        },
        log);
    renewing.emplace(
        "prolonging leases", std::chrono::milliseconds(config.lease) / kBeatsInALease,
        [this] {
          queue.renew_leases();
          if (node.is_shared) blobs.room().recount(store.stored_bytes());
        },
        log);
    if (node.is_shared)
      sweeping_files.emplace(
          "sweeping files", 1h, [&] { store::sweep_at_start(store, mesh_store, blobs, log); }, log);
    mending.emplace(
        "mending after a loss of the database", 1s, [this] { queue.mend(); }, log);
    calling.emplace(
        "calling webhooks", 1s, [this] { webhooks.call_due(); }, log);
    trimming.emplace(  // what large jobs leave free in the heaps of their threads
        "returning memory", 10s, [] { ::malloc_trim(0); }, log);
  }

  void tell_state() {
    tell_process(metrics);
    if (http) tell_connections(metrics, *http);
    tell_jobs(metrics, queue);
    metrics.tell(Metric::event_streams, {}, [&] { return streams.open_count(); });
    tell_store(metrics, blobs, blobs_root(config), webhooks);
    tell_caches(metrics, solver_cache, {&results.counts(), &pictures.counts(), &meshes.counts()});
  }

  /// Stops the edge, then the admin port: probes answer until the last request is answered.
  void stop() {
    is_stopped = true;
    if (http) {
      http->stop();
      serving.join();
    }
    if (!admin) return;
    admin->stop();
    serving_admin.join();
  }

  std::vector<http::Route> routes() {
    const routes::JobServices services{store,       queue,   blobs, events,        streams,
                                       submissions, results, links, config.limits, waiters};
    std::vector<http::Route> all;
    routes::add_job_routes(all, services);
    routes::add_unwrap_route(all, services);
    routes::add_link_routes(all, services);
    routes::add_mesh_routes(all, meshes, std::chrono::seconds(config.keep_seconds));
    routes::add_picture_routes(all, store, pictures);
    routes::add_info_routes(all, config.limits, bucket::link_origin(config.bucket));
    routes::add_probe_routes(all, readiness);
    return all;
  }

  const config::Config config;
  work::SolverCache solver_cache{config.memory, config.workers};
  const work::Isolation isolation;
  store::DataLock lock;
  const store::Node node;
  blobs::BlobStore blobs;
  store::JobStore store;
  const database::DatabaseAddress other_rows = rows_besides_jobs(config);
  store::MeshStore mesh_store;
  store::QuotaReservations reservations{store};
  const uploads::UploadRooms rooms{reservations, blobs.room()};
  ConcurrencyLimit waiters{config::most_waiting(config), half_of_the_rest};
  Metrics metrics;
  const std::shared_ptr<Wakeup> news = std::make_shared<Wakeup>();
  jobs::EventFeed events{kEventsKept, kFeedsKept, &metrics, news};
  jobs::JobQueue queue;
  std::optional<OtherNodes> other_nodes;
  routes::EventStreams streams;
  access::KeyStore keys;
  const std::string secret = secret_of(config, node);
  const access::LinkSigner links;
  access::Access access;
  const http::Cors cors;
  const http::Sites sites;
  webhooks::Webhooks webhooks;
  results::Renderer renderer;
  uploads::Meshes meshes;
  sources::Sources sources;
  uploads::Submissions submissions;
  results::ResultStore results;
  store::Sweeper sweeper;
  results::PictureStore pictures;
  const routes::Readiness readiness{
      queue, store,
      [this] { return store::is_whole(config.data, blobs_root(config), config.database); },
      [this] { return !workers || workers->are_left(); }};
  http::Router router;
  std::optional<http::HttpServer> http;
  http::Router admin_router;
  std::optional<http::HttpServer> admin;
  std::optional<Periodic> sweeping, sweeping_files, renewing, mending, calling, trimming;
  std::optional<jobs::WorkerPool> workers;
  std::jthread serving, serving_admin;
  bool is_stopped = false;
};

Service::Service(const config::Config& config, const Log& log,
                 const work::WorkerFunctions& functions) try
    : parts_(std::make_unique<Parts>(config, log, functions)) {
} catch (const InsideError& error) {  // read by the operator alone
  throw Error(error.code(), error.reason());
}

Service::~Service() {
  if (parts_->is_stopped) return;
  parts_->queue.drain(std::chrono::seconds(0));
  parts_->events.end_all();
  parts_->stop();
}

int Service::port() const { return parts_->http ? parts_->http->port() : 0; }
std::optional<int> Service::admin_port() const {
  return parts_->admin ? std::optional(parts_->admin->port()) : std::nullopt;
}

const std::vector<http::Route>& Service::routes() const { return parts_->router.routes(); }
void Service::stop_waiting() { parts_->queue.stop_waiting(); }

bool Service::drain() {
  const bool is_idle = parts_->queue.drain(std::chrono::seconds(parts_->config.drain_seconds));
  parts_->events.end_all();
  parts_->stop();
  return is_idle && parts_->workers->lost() == 0;
}

}  // namespace unwrapd::server
