#pragma once
// The call itself: one POST to an address that was checked, its status, and nothing else of what
// the other side says.

#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "server/webhooks/webhook_url.hpp"

namespace unwrapd::server {

struct WebhookCall {
  WebhookUrl url;
  std::string address;  ///< of its host, in numbers: no other is connected to
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;  ///< JSON
};

/// What went wrong, empty when the answer was 2xx. Takes 15 s at most, less when it is to stop,
/// follows no redirect, and does not read the answer's body.
std::string post_webhook(const WebhookCall& call, const std::stop_token& stop);

}  // namespace unwrapd::server
