#pragma once
// The call itself: one POST to an address that was checked, its status, and when to call again.

#include <chrono>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "server/webhooks/webhook_url.hpp"

namespace unwrapd::server::webhooks {

struct WebhookCall {
  WebhookUrl url;
  std::string address;  ///< of its host, in numbers: no other is connected to
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;  ///< JSON
};

struct WebhookAnswer {
  std::string failure;                    ///< what went wrong; empty when the status is 2xx
  bool is_gone = false;                   ///< 410: the receiver wants no further call
  std::chrono::seconds retry_after = {};  ///< asked for; 0: it did not ask
};

/// Takes 15 s at most, less when it is to stop. Follows no redirect, uses no proxy, and does not
/// read the answer's body. Throws Error{internal} when libcurl cannot be used.
WebhookAnswer post_webhook(const WebhookCall& call, const std::stop_token& stop);

}  // namespace unwrapd::server::webhooks
