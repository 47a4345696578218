#pragma once
// What a node needs where others work on the same store: who it is, where the files of all are, and
// word of what the others do.

#include <memory>

#include "server/access/key_store.hpp"
#include "server/base/log.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/config/config.hpp"
#include "server/database/database_address.hpp"
#include "server/jobs/event_exchange.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server {

/// This node, with an id that lasts as long as its data directory.
store::Node node_of(const config::Config& config);
/// The database, as this node opens it to work on it.
database::PostgresAddress database_of(const config::Config& config, const store::Node& node);
/// The directory of blobs/, incoming/ and lost/; of a bucket, of the copies of this node.
std::filesystem::path blobs_root(const config::Config& config);
/// The files of all jobs. Throws InsideError{storage_failed} where they are in a bucket that cannot
/// be used.
blobs::BlobStore blobs_of(const config::Config& config, const store::Node& node, const Log& log);
/// The rows of meshes, keys and webhooks. With a URL they use one connection, beside that of jobs.
database::DatabaseAddress rows_besides_jobs(const config::Config& config);
/// rows: of rows_besides_jobs(), whose tables are there.
access::KeyStore keys_of(const config::Config& config, const database::DatabaseAddress& rows);
/// The secret that signs links and webhooks. The tables must be there.
std::string secret_of(const config::Config& config, const store::Node& node);

/// Exchanges news with other nodes while it exists; there are none where nothing is shared.
class OtherNodes {
 public:
  OtherNodes(const database::PostgresAddress& database, store::JobStore& store,
             blobs::BlobStore& blobs, jobs::EventFeed& events, jobs::JobQueue& queue,
             const Log& log);

 private:
  std::unique_ptr<jobs::EventExchange> exchange_;
};

}  // namespace unwrapd::server
