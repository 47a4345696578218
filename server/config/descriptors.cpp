#include "server/config/descriptors.hpp"

#include <algorithm>
#include <string>

#include "core/base/error.hpp"
#include "server/config/component_config.hpp"

namespace unwrapd::server::config {
namespace {

constexpr std::int64_t kOfTheServer = 32;  // stores, listeners, bells, folders
constexpr std::int64_t kOfARequest = 3;    // a file, its digests, the folder of both
constexpr std::int64_t kOfAWorker = 13;    // a mesh with buffers, its results, two processes
constexpr std::int64_t kFewestParts = 4;   // at least a quarter is for connections

}  // namespace

int connections_within(std::int64_t files, const Config& config) {
  if (files < kFewestDescriptors) {
    throw Error(ErrorCode::internal,
                "Only " + std::to_string(files) + " files may be open; allow " +
                    std::to_string(kFewestDescriptors) + " or more (ulimit -n, LimitNOFILE).");
  }
  const std::int64_t admin = config.admin ? admin_config(*config.admin).max_connections : 0;
  const std::int64_t kept_back = kOfTheServer + kOfARequest * http_config(config).max_requests +
                                 kOfAWorker * config.workers + admin;
  const std::int64_t left = std::max(files - kept_back, files / kFewestParts);
  return static_cast<int>(std::min<std::int64_t>(left, config.edge.max_connections));
}

}  // namespace unwrapd::server::config
