#pragma once
// Where a webhook may go: to hosts that the operator allows, at public addresses.

#include <string>
#include <vector>

#include "server/outbound/outbound_url.hpp"

namespace unwrapd::server::webhooks {

struct WebhookConfig {
  std::vector<std::string>
      allowed_hosts;           ///< "example.com", "*.example.com" or "*"; none: no calls
  bool allow_private = false;  ///< addresses of this machine and of private networks
  int retry_seconds = 5;       ///< until the second try, doubled for each further one
};

using WebhookUrl = outbound::OutboundUrl;

/// Throws Error{webhook_refused}: the text is no such URL, has a user, or is of a host that is not
/// allowed.
WebhookUrl parse_webhook(const std::string& text, const WebhookConfig& config);

/// The host of a webhook's address as parse_webhook() reads it; the text itself where it is none.
std::string webhook_host(const std::string& text);

/// The addresses of a host in numbers. Throws Error{webhook_refused} when there is none, or one
/// that may not be called.
std::vector<std::string> resolve_webhook(const WebhookUrl& url, const WebhookConfig& config);

}  // namespace unwrapd::server::webhooks
