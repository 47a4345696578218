// The options of who may use the server, and whom the server may call.
#include <algorithm>

#include "server/config/config_row.hpp"

namespace unwrapd::server::config {
namespace {

/// Browsers send origins, and webhooks' hosts are compared, in small letters.
bool has_capital(const std::string& text) {
  return std::ranges::any_of(text, [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// "https://example.com", without a path, as browsers write it.
void check_origin(const std::string& item) {
  const std::size_t scheme = item.find("://");
  const bool whole = scheme != std::string::npos && item.size() > scheme + 3 &&
                     item.find_first_of("/*", scheme + 3) == std::string::npos;
  if (item != "*" && (!whole || has_capital(item)))
    expected("origins like https://example.com, in small letters, or *");
}

void check_host(const std::string& item) {
  const std::string host = item.starts_with("*.") ? item.substr(2) : item;
  const bool whole = !host.empty() && host.find_first_of("*/:@? ") == std::string::npos;
  if (item != "*" && (!whole || has_capital(item)))
    expected("hosts like example.com or *.example.com, in small letters, or *");
}

}  // namespace

ConfigGroup admitting() {
  return {
      .title = "Access",
      .rows = {
          on_off({"require-keys", "", "Require API keys on loopback, too"}, &Config::access,
                 &access::AccessConfig::require_keys),
          text({"key-file", "PATH",
                "File with one more API key of the scope admin, 32 characters or more: for a "
                "mounted secret"},
               &Config::access, &access::AccessConfig::key_file),
          on_off({"insecure", "", "Require no API keys although other machines can connect"},
                 &Config::access, &access::AccessConfig::insecure),
          list({"allowed-hosts", "LIST",
                "Host names that the server answers to when it requires no API keys: example.com, "
                "*.example.com or *. It always answers to addresses and localhost"},
               check_host, &Config::allowed_hosts),
          list({"cors-origins", "LIST",
                "Origins whose pages may call the server from a browser, or *"},
               check_origin, &Config::cors_origins)}};
}

ConfigGroup calling_out() {
  using S = sources::SourceConfig;
  const auto sources = &Config::sources;
  return {
      .title = "Calls to other servers",
      .rows = {
          list(
              {"webhook-hosts", "LIST",
               "Hosts that webhooks may call: example.com, *.example.com or *. Empty: no webhooks"},
              check_host, &Config::webhooks, &webhooks::WebhookConfig::allowed_hosts),
          on_off({"webhook-private", "",
                  "Allow webhooks to addresses of this machine and of private networks"},
                 &Config::webhooks, &webhooks::WebhookConfig::allow_private),
          number(
              {"webhook-retry-seconds", "N",
               "Seconds until the second attempt of a webhook; doubled for each further attempt"},
              {1, 3600}, &Config::webhooks, &webhooks::WebhookConfig::retry_seconds),
          list({"source-hosts", "LIST",
                "Hosts from which jobs may have their mesh read (source): example.com, "
                "*.example.com or *. Empty: none"},
               check_host, sources, &S::allowed_hosts),
          on_off({"source-private", "",
                  "Allow sources at addresses of this machine and of private networks"},
                 sources, &S::allow_private),
          on_off({"source-http", "", "Allow sources by http, without TLS, too"}, sources,
                 &S::allow_http),
          number({"source-seconds", "N", "Seconds that reading one source may take"}, {1, 3600},
                 sources, &S::seconds),
          number({"max-sources", "N", "Sources read at once; more are refused (429)"}, {1, 256},
                 sources, &S::at_once)}};
}

}  // namespace unwrapd::server::config
