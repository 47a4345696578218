#pragma once
// Which requests are allowed. Every route needs a scope. Where keys are required, a request brings
// one as `Authorization: Bearer unw_...`; the scopes, rate and quota of that key apply to it. A
// signed link (signed_link.hpp) opens one resource without a key, an upload ticket takes one job.

#include <filesystem>
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
};

}  // namespace unwrapd::server::access
