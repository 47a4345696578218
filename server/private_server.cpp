#include "server/private_server.hpp"

#include <stdlib.h>  // NOLINT: mkdtemp is POSIX

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>

#include "core/base/error.hpp"
#include "server/access/key_store.hpp"
#include "server/base/log.hpp"
#include "server/config/config.hpp"
#include "server/service.hpp"

namespace unwrapd::server {
namespace {

namespace fs = std::filesystem;

fs::path new_folder() {
  std::error_code error;
  std::string name = (fs::temp_directory_path(error) / "unwrap.XXXXXX").string();
  if (error || ::mkdtemp(name.data()) == nullptr)
    throw Error(ErrorCode::storage_failed,
                "A temporary folder cannot be made; set TMPDIR to a folder that can be written.");
  return name;
}

/// The one caller's own machine has no other jobs to protect: time and bytes are as good as free.
config::Config config_in(const fs::path& folder, int jobs) {
  config::Config config;
  config.listen = {"127.0.0.1", 0};
  config.data = folder;
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  config.workers = std::clamp(jobs, 1, cores);
  config.threads = cores / config.workers;
  config.isolate = config::Isolate::off;
  config.access.require_keys = true;
  config.edge.max_requests = 64;
  config.edge.max_connections = config.edge.max_idle_connections = 1024;
  config.limits.max_body_bytes = std::int64_t{4} << 30;
  config.limits.max_job_seconds = 7 * 24 * 60 * 60;
  return config;
}

std::string new_key(const fs::path& folder) {
  access::ApiKey key;
  key.name = "unwrap";
  key.scopes = {.submit = true, .read = true, .admin = false};
  return access::KeyStore(folder).add(key);
}

}  // namespace

/// Folder, first to come and last to go, and what lies in it.
struct PrivateServer::Parts {
  explicit Parts(int jobs) : folder(new_folder()) {
    try {
      key = new_key(folder);
      service.emplace(config_in(folder, jobs), log);
    } catch (...) {
      remove();
      throw;
    }
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  ~Parts() {
    service.reset();
    remove();
  }
  void remove() const {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }

  fs::path folder;
  std::string key;
  Log log{LogLevel::off};
  std::optional<Service> service;
};

PrivateServer::PrivateServer(int jobs) : parts_(std::make_unique<Parts>(jobs)) {}
PrivateServer::~PrivateServer() = default;

std::string PrivateServer::url() const {
  return "http://127.0.0.1:" + std::to_string(parts_->service->port());
}

const std::string& PrivateServer::key() const { return parts_->key; }

}  // namespace unwrapd::server
