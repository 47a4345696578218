#include "client/server_url.hpp"

#include "tests/client/expect_failure.hpp"

namespace unwrapd::client {
namespace {

TEST(ServerUrl, KeepsSchemeHostAndPort) {
  EXPECT_EQ(parse_server_url("http://127.0.0.1:8080").origin, "http://127.0.0.1:8080");
  EXPECT_EQ(parse_server_url("https://uv.example").origin, "https://uv.example");
  EXPECT_EQ(parse_server_url("http://[::1]:80").origin, "http://[::1]:80");
  EXPECT_EQ(parse_server_url("http://[::1]").origin, "http://[::1]");
}

TEST(ServerUrl, ReadsASchemeInAnyLetters) {  // RFC 3986, 3.1
  EXPECT_EQ(parse_server_url("HTTP://127.0.0.1:8080").origin, "http://127.0.0.1:8080");
  EXPECT_EQ(parse_server_url("Https://uv.example/a").origin, "https://uv.example");
}

TEST(ServerUrl, TakesHttpWhereNoSchemeIsGiven) {
  EXPECT_EQ(parse_server_url("localhost:8080").origin, "http://localhost:8080");
}

TEST(ServerUrl, KeepsAPrefixWithoutItsLastSlash) {
  EXPECT_EQ(parse_server_url("http://host/").prefix, "");
  EXPECT_EQ(parse_server_url("http://host/tools/uv/").prefix, "/tools/uv");
}

TEST(ServerUrl, ReadsAListWithCommas) {
  const std::vector<ServerUrl> all = parse_server_urls("http://a:1,b:2/uv");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].origin, "http://a:1");
  EXPECT_EQ(all[1].origin + all[1].prefix, "http://b:2/uv");
  for (const char* list : {"", ",", "a,", "a,,b", "a, b"})
    expect_failure(ExitCode::usage, [&] { parse_server_urls(list); });
}

TEST(ServerUrl, RefusesWhatIsNoAddressAndShowsHowToWriteOne) {
  for (const char* text : {"", "http://", "ftp://host", "http://host:", "http://host:0",
                           "http://host:65536", "http://host:80x", "http://[::1", "http://[::1]80",
                           "http://user@host", "http://host?query", "ho st", "http://ho%st"}) {
    const std::string message = expect_failure(ExitCode::usage, [&] { parse_server_url(text); });
    EXPECT_NE(message.find("http://host:port"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace unwrapd::client
