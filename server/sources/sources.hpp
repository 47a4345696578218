#pragma once
// Meshes that jobs name by an address (`source`) rather than send. A server that reads what its
// clients name can be made to read what only it can reach, so that the rules are those of webhooks
// (outbound_url.hpp), for every redirect anew: off unless the operator names hosts, public
// addresses only, https only; and bounds of size, time, redirects and downloads at once. The thread
// of the request reads, and the job is accepted when all bytes are stored, as after an upload: a
// crash loses nothing that was acknowledged (ADR 0068).

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/concurrency_limit.hpp"
#include "server/base/log.hpp"
#include "server/base/metrics.hpp"
#include "server/http/http.hpp"
#include "server/outbound/outbound_url.hpp"

namespace unwrapd::server::sources {

struct SourceConfig {
  std::vector<std::string>
      allowed_hosts;           ///< "example.com", "*.example.com" or "*"; none: no sources
  bool allow_private = false;  ///< addresses of this machine and of private networks
  bool allow_http = false;     ///< without TLS, too
  int seconds = 45;            ///< for one download, from resolving its host to its last byte; our
                               ///< clients, and many proxies, give up after 60 s of silence
  int at_once = 8;             ///< downloads; more are refused
};

/// A download is wanted for this request.
struct SourceUse {
  std::string owner;               ///< of the job
  http::HasLeft has_left = {};     ///< a client that has left wants nothing
  std::function<bool()> draining;  ///< so does a server that shuts down
};

/// Thread-safe.
class Sources {
 public:
  /// max_bytes: of one file. Throws Error{internal} when hosts are allowed and libcurl is missing.
  Sources(const SourceConfig& config, std::int64_t max_bytes, const Log& log, Metrics& metrics);

  /// The file at this address, to be read like a body that was sent. Throws Error: source_refused,
  /// rate_limited when too many are read. Its read() throws source_refused, source_failed,
  /// body_too_large, unsupported_media_type, draining, and what its sink throws. All but
  /// rate_limited and draining have the pointer /source. Must not outlive this.
  [[nodiscard]] std::unique_ptr<http::BodyReader> open(const std::string& address, SourceUse use);

 private:
  class Download;

  [[nodiscard]] outbound::OutboundUrl parse(const std::string& address) const;
  [[nodiscard]] outbound::OutboundUrl follow(const outbound::OutboundUrl& from,
                                             const std::string& location) const;
  [[nodiscard]] std::vector<std::string> resolve(const outbound::OutboundUrl& url,
                                                 bool is_redirect) const;

  const SourceConfig config_;
  const std::int64_t max_bytes_;
  const Log& log_;
  Metrics& metrics_;
  ConcurrencyLimit downloads_;
};

}  // namespace unwrapd::server::sources
