#pragma once
// Where a webhook may go. A server that calls addresses which its users choose can be made to call
// what only it can reach (server-side request forgery): so the host must be allowed by the
// operator, every address that it resolves to must be a public one, the call goes to the address
// that was checked, and redirects are not followed. Checking the name alone was rejected: it may
// resolve to another address a moment later.

#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::webhooks {

struct WebhookConfig {
  std::vector<std::string>
      allowed_hosts;           ///< "example.com", "*.example.com" or "*"; none: no calls
  bool allow_private = false;  ///< addresses of this machine and of private networks
  int retry_seconds = 5;       ///< until the second try, doubled for each further one
};

/// http://host[:port][/path][?query] or https://...
struct WebhookUrl {
  bool is_https = true;
  std::string host;
  int port = 443;
  std::string target = "/";  ///< path and query
};

/// Throws Error{webhook_refused}: the text is no such URL, has a user, or is of a host that is not
/// allowed.
WebhookUrl parse_webhook(const std::string& text, const WebhookConfig& config);

/// The host of a webhook's address as parse_webhook() reads it; the text itself where it is none.
std::string webhook_host(const std::string& text);

/// Whether an address in numbers is one of the public internet: not of this machine, of a private
/// or shared network, link-local, multicast or reserved (RFC 6890); false for what is no address.
bool is_public_address(const std::string& address);

/// The addresses of a host in numbers. Throws Error{webhook_refused} when there is none, or one
/// that may not be called.
std::vector<std::string> resolve_webhook(const WebhookUrl& url, const WebhookConfig& config);

}  // namespace unwrapd::server::webhooks
