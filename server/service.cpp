#include "server/service.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "server/base/identity.hpp"
#include "server/base/inside_error.hpp"
#include "server/base/periodic.hpp"
#include "server/config/parts_config.hpp"
#include "server/http/access_log.hpp"
#include "server/http/cors.hpp"
#include "server/http/sites.hpp"
#include "server/jobs/worker_pool.hpp"
#include "server/routes/admin_routes.hpp"
#include "server/routes/info_routes.hpp"
#include "server/routes/job_routes.hpp"
#include "server/routes/mesh_routes.hpp"
#include "server/routes/picture_routes.hpp"
#include "server/store/data_lock.hpp"
#include "server/store/store_file.hpp"
#include "server/store/sweeper.hpp"
#include "server/webhooks/webhooks.hpp"

namespace unwrapd::server {
namespace {

constexpr std::chrono::seconds kHeartbeat{10};
constexpr std::chrono::seconds kWebhookPause{1};
constexpr std::chrono::seconds kTrimPause{10};
constexpr std::size_t kEventsKept = 1024;  // of each job
constexpr std::size_t kFeedsKept = 64;     // of finished jobs

}  // namespace

struct Service::Parts {
  Parts(const Config& given, const Log& log, const Duties& duties)
      : config(given),
        isolation(isolation_of(config, solver_cache, duties)),
        lock(config.data),
        blobs(config.data, config.disk),
        store(store_in(config.data, blobs)),
        mesh_store(config.data / kStoreFile),
        queue(store, blobs, events, log,
              {.max_queue = config.limits.max_queue,
               .workers = config.workers,
               .max_stored = config.max_stored_jobs,
               .stop = most_stopping(config)}),
        streams(events, config.limits.max_streams),
        keys(config.data, config.access.key_file),
        secret(secret_in(config.data / kSecretFile)),
        links(secret),
        access(keys, links, asks_for_keys(config.access, config.listen.host)),
        cors(config.cors_origins),
        sites(config.allowed_hosts, cors),
        webhooks(config.data / kStoreFile, secret, config.webhooks, log,
                 [this] { return store.now(); }),
        renderer(blobs, config.limits, log, isolation,
                 making_limits(config, solver_cache.memory_limit()), duties),
        meshes(mesh_store, store, blobs, rooms, renderer),
        submissions(queue, store, blobs, config.limits, config.webhooks, meshes, rooms),
        results(blobs, renderer),
        sweeper(store, mesh_store, blobs, log, std::chrono::seconds(config.keep_seconds)),
        pictures(blobs, renderer),
        router(routes(), log,
               [this](Request& request, std::string_view route) { access.admit(request, route); }),
        http(http_config(config), main_uses(log), log),
        admin_router(admin_routes(readiness, metrics), log) {
    if (config.admin) {
      const bool only_here = !asks_for_keys({}, config.admin->host);
      const auto told = [this, only_here](const Request& request) {
        const std::optional<Error> refused =
            only_here ? sites.refusal(request) : std::nullopt;  // by a page in a browser here
        return refused ? error_response(*refused) : admin_router.answer(request);
      };
      admin.emplace(admin_config(*config.admin), uses(told, log, LogLevel::debug), log);
    }
    warn_without_keys(log);
    tell_state();
    tell_isolation(isolation, config, log, metrics);
    queue.recover(isolation.possible);
    sweep_at_start(store, mesh_store, blobs, log);
    blobs.room().on_shortage(
        {.evict = [this] { return evict_oldest(store, mesh_store, blobs); },
         .bytes = [this] { return store.evictable_bytes() + blobs.lost().bytes(); }});
    blobs.on_keeping({.claim = [this](const std::string& id,
                                      std::int64_t bytes) { return claim_to_keep(id, bytes); },
                      .kept =
                          [this](std::string_view id, std::int64_t bytes) {
                            is_mesh_id(id) ? mesh_store.set_stored_bytes(id, bytes)
                                           : store.set_stored_bytes(id, bytes);
                          }});
    start_periodic(log);
    workers.emplace(queue, blobs, config.limits, log,
                    WorkerConfig{.workers = config.workers,
                                 .threads = config.threads,
                                 .core = &solver_cache,
                                 .claims = &claims,
                                 .most_bytes = [this](const auto& id) { return most_bytes(id); },
                                 .isolation = isolation,
                                 .duties = duties,
                                 .on_force =
                                     [this](std::string_view how) {
                                       metrics.count(Metric::jobs_forced, {{"ended", how}});
                                     }});
    metrics.tell(Metric::lost_threads, {}, [this] { return workers->lost(); });
    serving = std::jthread([this] { http.serve(); });
    if (admin) serving_admin = std::jthread([this] { admin->serve(); });
  }

  /// A server that nobody can use must not look like one that runs.
  void warn_without_keys(const Log& log) {
    if (!asks_for_keys(config.access, config.listen.host) || keys.has_any()) return;
    log.warning("API keys are required and none exists yet; add one",
                {{"command", "unwrapd keys add --data " + config.data.string() +
                                 " --name NAME --scopes submit,read"}});
  }

  /// Of an owner's quota; 0: none.
  std::int64_t most_bytes(const std::string& owner) {
    const std::optional<ApiKey> key = keys.with_id(owner);
    return key ? key->quota.max_bytes : 0;
  }

  /// So many bytes more for a job's owner, if he may store them. A mesh's analysis is short.
  std::shared_ptr<void> claim_to_keep(const std::string& id, std::int64_t bytes) {
    const std::optional<JobRecord> job = store.find(id);
    if (!job && !is_mesh_id(id)) return nullptr;
    auto claim = std::make_shared<Claim>(claims, job ? job->owner : std::string());
    if (job && !claim->try_set(bytes, most_bytes(job->owner))) return nullptr;
    return claim;
  }

  HttpUses main_uses(const Log& log) {
    HttpUses all =
        uses([this](const Request& request) { return answer(request); }, log, LogLevel::info);
    all.news = news;
    return all;
  }

  HttpUses uses(Handler answer_one, const Log& log, LogLevel level) {
    return {.answer = std::move(answer_one),
            .observe = [this, &log,
                        level](const Exchanged& done) { tell_exchange(done, log, level, metrics); },
            .trusted_proxies = AddressSet(config.edge.trusted_proxies)};
  }

  Response answer(const Request& request) const {
    if (!asks_for_keys(config.access, config.listen.host))
      if (const std::optional<Error> refused = sites.refusal(request))
        return error_response(*refused);
    std::optional<Response> early = cors.preflight(request);
    Response response = early ? std::move(*early) : router.answer(request);
    cors.allow(request, response);
    return response;
  }

  void start_periodic(const Log& log) {
    sweeping.emplace(
        "sweeping", sweeper.pause(),
        [this] {
          sweeper.sweep_once();
          blobs.remove_left();
        },
        log);
    beating.emplace(
        "prolonging leases", kHeartbeat, [this] { queue.beat(); }, log);
    calling.emplace(
        "calling webhooks", kWebhookPause, [this] { webhooks.call_due(); }, log);
    trimming.emplace(  // what large jobs leave free in the heaps of their threads
        "returning memory", kTrimPause, [] { ::malloc_trim(0); }, log);
  }

  void tell_state() {
    tell_process(metrics);
    metrics.tell(Metric::connections, {{"state", "parked"}}, [&] { return http.parked(); });
    metrics.tell(Metric::connections, {{"state", "served"}},
                 [&] { return http.open() - http.parked(); });
    metrics.tell(Metric::event_streams, {}, [&] { return streams.open_count(); });
    metrics.tell(Metric::stored_bytes, {}, [&] { return blobs.room().used_bytes(); });
    tell_caches();
  }

  void tell_caches() {
    const auto tell_asked = [&](std::string_view cache, auto hits, auto misses) {
      metrics.tell(Metric::cache_requests, {{"cache", cache}, {"outcome", "hit"}}, hits);
      metrics.tell(Metric::cache_requests, {{"cache", cache}, {"outcome", "miss"}}, misses);
    };
    const auto tell_files = [&](std::string_view cache, const FileCounts& of) {
      tell_asked(
          cache, [&of] { return of.hits.load(); }, [&of] { return of.misses.load(); });
      metrics.tell(Metric::made_bytes, {{"cache", cache}}, [&of] { return of.bytes.load(); });
    };
    tell_asked(
        "solver", [&] { return solver_cache.counters().hits; },
        [&] { return solver_cache.counters().misses; });
    metrics.tell(Metric::cache_bytes, {{"cache", "solver"}},
                 [&] { return solver_cache.counters().bytes; });
    tell_files("result", results.counts());
    tell_files("picture", pictures.counts());
    tell_files("analysis", meshes.counts());
  }

  /// The probes answer until the last request is.
  void stop() {
    http.stop();
    serving.join();
    if (!admin) return;
    admin->stop();
    serving_admin.join();
  }

  std::vector<Route> routes() {
    const JobServices services{store,       queue,   blobs, events,        streams,
                               submissions, results, links, config.limits, waiters};
    std::vector<Route> all;
    add_job_routes(all, services);
    add_unwrap_route(all, services);
    add_mesh_routes(all, meshes, std::chrono::seconds(config.keep_seconds));
    add_picture_routes(all, store, pictures);
    add_info_routes(all, config.limits);
    add_probe_routes(all, readiness);
    return all;
  }

  const Config config;
  SolverCache solver_cache{config.memory, config.workers};
  const Isolation isolation;
  DataLock lock;
  BlobStore blobs;
  JobStore store;
  MeshStore mesh_store;
  Claims claims{store};
  const UploadRooms rooms{claims, blobs.room()};
  Waiters waiters{most_waiting(config)};
  Metrics metrics;
  const std::shared_ptr<Doorbell> news = std::make_shared<Doorbell>();
  EventFeed events{kEventsKept, kFeedsKept, &metrics, news};
  JobQueue queue;
  EventStreams streams;
  KeyStore keys;
  const std::string secret;
  const LinkSigner links;
  Access access;
  const Cors cors;
  const Sites sites;
  Webhooks webhooks;
  Renderer renderer;
  Meshes meshes;
  Submissions submissions;
  ResultStore results;
  Sweeper sweeper;
  PictureStore pictures;
  const Readiness readiness{queue, store, config.data,
                            [this] { return !workers || workers->are_left(); }};
  Router router;
  HttpServer http;
  Router admin_router;
  std::optional<HttpServer> admin;
  std::optional<Periodic> sweeping;
  std::optional<Periodic> beating;
  std::optional<Periodic> calling;
  std::optional<Periodic> trimming;
  std::optional<WorkerPool> workers;
  std::jthread serving, serving_admin;
};

Service::Service(const Config& config, const Log& log, const Duties& duties) try
    : parts_(std::make_unique<Parts>(config, log, duties)) {
} catch (const InsideError& error) {  // read by the operator alone
  throw Error(error.code(), error.reason());
}

Service::~Service() {
  if (!parts_->serving.joinable()) return;
  parts_->queue.drain(std::chrono::seconds(0));
  parts_->events.end_all();
  parts_->stop();
}

int Service::port() const { return parts_->http.port(); }

std::optional<int> Service::admin_port() const {
  if (!parts_->admin) return std::nullopt;
  return parts_->admin->port();
}

void Service::hurry() { parts_->queue.hurry(); }

bool Service::drain() {
  const bool is_idle = parts_->queue.drain(std::chrono::seconds(parts_->config.drain_seconds));
  parts_->events.end_all();
  parts_->stop();
  return is_idle && parts_->workers->lost() == 0;
}

}  // namespace unwrapd::server
