#include "server/webhooks/webhook_url.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "server/http/sites.hpp"

namespace unwrapd::server::webhooks {
namespace {

constexpr outbound::UrlUse kWebhook{.refused = ErrorCode::webhook_refused, .whose = "webhook"};

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::webhook_refused, what); }

}  // namespace

WebhookUrl parse_webhook(const std::string& text, const WebhookConfig& config) {
  WebhookUrl url = outbound::read_url(text, kWebhook);
  if (!http::is_named(url.host, config.allowed_hosts)) {
    refuse("This server calls no webhooks at " + url.host +
           "; its operator can allow the host by --webhook-hosts.");
  }
  if (!config.allow_private && outbound::is_address(url.host) &&
      !outbound::is_public_address(url.host))
    refuse("The webhook's address is not a public one; give another.");
  return url;
}

std::string webhook_host(const std::string& text) {
  try {
    return outbound::read_url(text, kWebhook).host;
  } catch (const Error&) {
    return text;
  }
}

std::vector<std::string> resolve_webhook(const WebhookUrl& url, const WebhookConfig& config) {
  std::vector<std::string> addresses = outbound::addresses_of(url.host);
  if (addresses.empty())
    refuse("The webhook's host has no address.");  // for the log, where no address of it goes
  if (!config.allow_private && !std::ranges::all_of(addresses, outbound::is_public_address))
    refuse("The webhook's host is at an address that is not public.");
  return addresses;
}

}  // namespace unwrapd::server::webhooks
