#include "server/other_nodes.hpp"

#include <utility>

#include "server/access/shared_secret.hpp"
#include "server/access/signed_link.hpp"
#include "server/base/errors.hpp"
#include "server/store/data_directory.hpp"

namespace unwrapd::server {

store::Node node_of(const config::Config& config) {
  if (!config::shares_blobs(config)) return {};
  const bool keeps_work =
      config.isolate == config::Isolate::off && config.memory.cache_bytes > 0 && config.workers > 0;
  return {.id = store::node_in(config.data), .is_shared = true, .keeps_work = keeps_work};
}

database::PostgresAddress database_of(const config::Config& config, const store::Node& node) {
  database::PostgresAddress database = config.database;
  database.node = node.id;
  return database;
}

std::filesystem::path blobs_root(const config::Config& config) {
  if (!config.bucket.url.empty()) return config.data / "copies";
  return config.shared_blobs.empty() ? config.data : config.shared_blobs;
}

blobs::BlobStore blobs_of(const config::Config& config, const store::Node& node, const Log& log) {
  if (config.bucket.url.empty())
    return blobs::BlobStore(blobs_root(config), config.disk,
                            node.is_shared ? blobs::Sharing::by_nodes : blobs::Sharing::none);
  const blobs::SweepAges ages{.unknown = std::chrono::seconds(config.keep_seconds)};
  auto folders =
      std::make_unique<blobs::BucketFolders>(bucket::address_of(config.bucket), node.id, ages, log);
  return {blobs_root(config), config.disk, std::move(folders), config.copied_bytes};
}

database::DatabaseAddress rows_besides_jobs(const config::Config& config) {
  const database::DatabaseAddress address = store::address_in(config.data, config.database);
  return config.database.url.empty() ? address : address.shared();
}

access::KeyStore keys_of(const config::Config& config, const database::DatabaseAddress& rows) {
  if (config.database.url.empty()) return access::KeyStore(config.data, config.access.key_file);
  return {rows, config.access.key_file};
}

std::string secret_of(const config::Config& config, const store::Node& node) {
  std::string own = access::secret_in(config.data / access::kSecretFile);
  return node.is_shared ? access::shared_secret(config.database, own) : std::move(own);
}

OtherNodes::OtherNodes(const database::PostgresAddress& database, store::JobStore& store,
                       blobs::BlobStore& blobs, jobs::EventFeed& events, jobs::JobQueue& queue,
                       const Log& log) {
  if (!store.node().is_shared) return;
  store.on_found([&blobs](const store::JobRecord& job) {
    const bool has_results = job.state == api::JobState::succeeded && !job.expired;
    blobs.note_row(job.id, job.seq, has_results ? job.attempt : 0);
    if (has_results) blobs.publish(job.id, job.attempt);
  });
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
