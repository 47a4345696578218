#pragma once
// Which requests are allowed. Every route needs a scope. Where keys are required, a request brings
// one as `Authorization: Bearer unw_...`; the scopes, rate and quota of that key apply to it. A
// signed link (signed_link.hpp) opens one resource without a key, an upload ticket takes one job.

#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "server/access/key_store.hpp"
#include "server/access/signed_link.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::access {

struct AccessConfig {
  bool require_keys = false;            ///< asked for on loopback, too
  bool insecure = false;                ///< not asked for anywhere
  std::filesystem::path key_file = {};  ///< of one key that the operator has made; asked for then
};

/// Whether keys are asked for: always where others than this machine can connect, unless the
/// operator insists, and where the operator has given one.
bool asks_for_keys(const AccessConfig& config, std::string_view host);

/// For how many requests one counts: a large picture for one each megapixel.
double cost_of(const http::Request& request, std::string_view route);

/// At most so many requests a minute, a minute's worth of them at once (token bucket).
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// 0 when the request may go on, else the whole seconds after which it may.
  /// cost: for how many requests it counts, which are a minute's worth at most.
  int wait_seconds(const std::string& key, std::int64_t per_minute, Clock::time_point now,
                   double cost = 1);

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled{};
  };
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

/// Thread-safe.
class Access {
 public:
  Access(KeyStore& keys, const LinkSigner& links, bool ask)
      : keys_(keys), links_(links), ask_(ask) {}

  /// Sets the caller of a request for what this route does, and takes off what signs its link.
  /// Throws Error: unauthorized, forbidden, rate_limited, invalid_link.
  void admit(http::Request& request, std::string_view route);

 private:
  [[nodiscard]] http::Caller caller_of(const http::Request& request, double cost);
  void open_link(http::Request& request, double cost);
  void spend(const ApiKey& key, double cost);
  [[nodiscard]] ApiKey key_of(const http::Request& request);

  KeyStore& keys_;
  const LinkSigner& links_;
  const bool ask_;
  RateLimit rates_;
};

}  // namespace unwrapd::server::access
