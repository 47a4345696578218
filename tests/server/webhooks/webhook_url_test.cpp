// Where a webhook may go.
#include "server/webhooks/webhook_url.hpp"

#include <gtest/gtest.h>

#include <string>

#include "core/base/error.hpp"
#include "tests/api/error_of.hpp"

namespace unwrapd::server::webhooks {
namespace {

TEST(Webhook, NamesThatResolveToThisMachineAreRefusedUnlessAllowed) {
  WebhookConfig config{.allowed_hosts = {"*"}};
  const WebhookUrl url = parse_webhook("http://localhost:81/x", config);
  EXPECT_EQ(error_of([&] { resolve_webhook(url, config); }).code(), ErrorCode::webhook_refused);
  config.allow_private = true;
  EXPECT_FALSE(resolve_webhook(url, config).empty());
}

TEST(Webhook, AddressesAreTakenApart) {
  const WebhookConfig any{.allowed_hosts = {"*"}};
  const WebhookUrl url = parse_webhook("https://Example.com:8443/a/b?c=d", any);
  EXPECT_TRUE(url.is_https);
  EXPECT_EQ(url.host, "example.com");
  EXPECT_EQ(url.port, 8443);
  EXPECT_EQ(url.target, "/a/b?c=d");
  EXPECT_EQ(parse_webhook("http://a.b", any).port, 80);
  EXPECT_EQ(parse_webhook("HTTP://a.b", any).port, 80);  // RFC 3986, 3.1
  EXPECT_TRUE(parse_webhook("HttpS://a.b", any).is_https);
  EXPECT_EQ(parse_webhook("http://a.b?x", any).target, "/?x");
  EXPECT_EQ(parse_webhook("http://[2606:4700:4700::1111]:8080/", any).host, "2606:4700:4700::1111");
  for (const char* text : {"", "ftp://a.b/", "https://", "https://user@a.b/", "https://a.b:0/",
                           "https://a.b:99999/", "https://a.b:/", "https://a b/", "https://a.b/#x",
                           "https://a.b/\r\nX: y", "//a.b/", "https://a.b\\c/"})
    EXPECT_EQ(error_of([&] { parse_webhook(text, any); }).code(), ErrorCode::webhook_refused)
        << text;
}

TEST(Webhook, AddressesOfPrivateNetworksAreRefusedBeforeAJobIsTaken) {
  WebhookConfig any{.allowed_hosts = {"*"}};
  for (const std::string host : {"10.1.2.3", "127.0.0.1", "127.1", "0x7f000001", "2130706433",
                                 "[::1]", "[fe80::1]", "[::ffff:10.1.2.3]", "169.254.169.254"}) {
    const std::string url = "http://" + host + ":81/x";
    any.allow_private = false;
    EXPECT_EQ(error_of([&] { parse_webhook(url, any); }).code(), ErrorCode::webhook_refused) << url;
    any.allow_private = true;
    EXPECT_NO_THROW(parse_webhook(url, any)) << url;
  }
}

TEST(Webhook, GoOnlyToHostsThatAreAllowed) {
  const WebhookConfig config{.allowed_hosts = {"a.example", "*.b.example"}};
  for (const char* text : {"https://a.example/", "https://x.b.example/", "https://x.y.b.example/"})
    EXPECT_NO_THROW(parse_webhook(text, config)) << text;
  for (const char* text : {"https://x.a.example/", "https://b.example/", "https://xb.example/",
                           "https://a.example.org/", "https://other/"})
    EXPECT_EQ(error_of([&] { parse_webhook(text, config); }).code(), ErrorCode::webhook_refused)
        << text;
  EXPECT_EQ(error_of([] { parse_webhook("https://a.example/", {}); }).code(),
            ErrorCode::webhook_refused);
}

}  // namespace
}  // namespace unwrapd::server::webhooks
