// Which addresses are public.
#include "server/outbound/outbound_url.hpp"

#include <gtest/gtest.h>

#include "server/outbound/transfer.hpp"
#include "tests/api/error_of.hpp"

namespace unwrapd::server::outbound {
namespace {

TEST(OutboundUrl, PublicAddressesAreToldFromAllOthers) {
  for (const char* address : {"127.0.0.1",
                              "10.1.2.3",
                              "172.16.0.1",
                              "172.31.255.255",
                              "192.168.1.1",
                              "169.254.169.254",
                              "100.64.0.1",
                              "0.0.0.0",
                              "224.0.0.1",
                              "255.255.255.255",
                              "192.0.2.1",
                              "198.18.0.1",
                              "::1",
                              "::",
                              "fe80::1",
                              "fc00::1",
                              "fd12::1",
                              "ff02::1",
                              "::ffff:127.0.0.1",
                              "::ffff:8.8.8.8",
                              "2001:db8::1",
                              "3fff::1",
                              "3fff:fff::1",
                              "2002:7f00:1::",
                              "64:ff9b::7f00:1",
                              "2001::1",
                              "fe80::1%eth0",
                              "nonsense"})
    EXPECT_FALSE(is_public_address(address)) << address;
  for (const char* address : {"8.8.8.8", "172.15.0.1", "172.32.0.1", "100.63.0.1", "100.128.0.1",
                              "2606:4700:4700::1111", "2a00:1450::1", "3fff:1000::1"})
    EXPECT_TRUE(is_public_address(address)) << address;
}

TEST(OutboundUrl, HostsInNumbersAreToldFromNames) {
  for (const char* host : {"127.0.0.1", "127.1", "0x7f000001", "2130706433", "::1", "0"})
    EXPECT_TRUE(is_address(host)) << host;
  for (const char* host : {"localhost", "a.example", "1.2.3.4.example", ""})
    EXPECT_FALSE(is_address(host)) << host;
}

TEST(OutboundUrl, RefusalsNameTheUseOfTheAddressAndItsPlace) {
  const UrlUse use{.refused = ErrorCode::source_refused, .whose = "source", .where = "/source"};
  for (const char* text : {"ftp://a.b/", "https://u@a.b/", "https://a.b:0/", "https://a b/"}) {
    const Error error = error_of([&] { read_url(text, use); });
    EXPECT_EQ(error.code(), ErrorCode::source_refused) << text;
    EXPECT_EQ(error.where(), "/source");
    EXPECT_TRUE(std::string_view(error.what()).starts_with("The source's address ")) << text;
  }
}

TEST(OutboundUrl, ALocationIsResolvedAsBrowsersDo) {
  const OutboundUrl from{.host = "a.b", .port = 8443, .target = "/c/d?e=f"};
  for (const auto& [location, expected] : {std::pair{"/x.glb", "https://a.b:8443/x.glb"},
                                           {"x.glb", "https://a.b:8443/c/x.glb"},
                                           {"../x.glb#top", "https://a.b:8443/x.glb"},
                                           {"?g", "https://a.b:8443/c/d?g"},
                                           {"//c.d/x", "https://c.d/x"},
                                           {"http://127.0.0.1/", "http://127.0.0.1/"},
                                           {"/a b", "https://a.b:8443/a%20b"},
                                           {"https://u:p@c.d/", "https://u:p@c.d/"}})
    EXPECT_EQ(resolve_location(from, location), expected) << location;
  EXPECT_EQ(resolve_location(from, "http://[::1"), "");
  const OutboundUrl v6{.is_https = false, .host = "fe80::1", .port = 80};
  EXPECT_EQ(resolve_location(v6, "/x"), "http://[fe80::1]:80/x");
}

}  // namespace
}  // namespace unwrapd::server::outbound
