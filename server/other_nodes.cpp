#include "server/other_nodes.hpp"

#include <utility>

#include "server/access/shared_secret.hpp"
#include "server/access/signed_link.hpp"
#include "server/base/errors.hpp"
#include "server/store/data_directory.hpp"

namespace unwrapd::server {

store::Node node_of(const config::Config& config) {
  if (config.shared_blobs.empty()) return {};
  return {.id = store::node_in(config.data), .is_shared = true};
}

store::PostgresAddress database_of(const config::Config& config, const store::Node& node) {
  store::PostgresAddress database = config.database;
  database.node = node.id;
  return database;
}

const std::filesystem::path& blobs_root(const config::Config& config) {
  return config.shared_blobs.empty() ? config.data : config.shared_blobs;
}

std::string secret_of(const config::Config& config, const store::Node& node) {
  std::string own = access::secret_in(config.data / access::kSecretFile);
  return node.is_shared ? access::shared_secret(config.database, own) : std::move(own);
}

OtherNodes::OtherNodes(const store::PostgresAddress& database, store::JobStore& store,
                       store::BlobStore& blobs, jobs::EventFeed& events, jobs::JobQueue& queue,
                       const Log& log) {
  if (!store.node().is_shared) return;
  store.on_success([&blobs](const store::JobRecord& job) { blobs.publish(job.id, job.attempt); });
  jobs::ExchangeCallbacks callbacks{
      .jobs_wait = [&queue] { queue.look_for_jobs(); },
      .jobs_cancelled = [&queue] { queue.stop_cancelled(); },
      .job_ended = [&queue](const std::string& job) { queue.tell_end_elsewhere(job); }};
  exchange_ = std::make_unique<jobs::EventExchange>(database, events, std::move(callbacks), log);
  events.share_with([this](store::EventRow event) { exchange_->share(std::move(event)); },
                    [this](const std::string&) { exchange_->fetch_now(); });
  queue.tell_others([this] { exchange_->tell_jobs_wait(); },
                    [this] { exchange_->tell_cancelled(); });
}

}  // namespace unwrapd::server
