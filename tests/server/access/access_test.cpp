// Who may do what: keys, rates, links; how webhooks are signed. tests/access asks the real
// server.
#include "server/access/access.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/identity.hpp"
#include "server/http/sites.hpp"
#include "server/webhooks/webhooks.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::access {
namespace {

http::Request request_of(const std::string& method, const std::string& path) {
  http::Request request;
  request.method = method;
  request.path = path;
  return request;
}

TEST(AsksForKeys, WhereOthersCanConnectUnlessTheOperatorInsists) {
  for (const char* host : {"127.0.0.1", "127.9.9.9", "::1", "localhost"}) {
    EXPECT_FALSE(asks_for_keys({}, host)) << host;
    EXPECT_TRUE(asks_for_keys({.require_keys = true}, host)) << host;
    EXPECT_TRUE(asks_for_keys({.key_file = "given"}, host)) << host;
  }
  for (const char* host : {"0.0.0.0", "::", "10.0.0.1", "example.com", "127.0.0.1.example.com"}) {
    EXPECT_TRUE(asks_for_keys({}, host)) << host;
    EXPECT_FALSE(asks_for_keys({.insecure = true}, host)) << host;
  }
}

class Keys : public testing::Test {
 protected:
  /// The caller of a request with this key.
  http::Caller admit(const std::string& text, const std::string& method = "GET") {
    http::Request request = request_of(method, "/v1/jobs");
    if (!text.empty()) request.headers.emplace("Authorization", "Bearer " + text);
    access_.admit(request, "/v1/jobs");
    return request.caller;
  }

  std::string add(const std::string& name, const Scopes& scopes) {
    ApiKey key;
    key.name = name;
    key.scopes = scopes;
    return keys_.add(key);
  }

  TempDir dir_;
  KeyStore keys_{dir_.path(), {}, postgres_of(dir_.path())};
  LinkSigner links_{"secret"};
  Access access_{keys_, links_, true};
};

TEST_F(Keys, AreStoredAsADigestAlone) {
  const std::string text = add("ci", {.submit = true});
  ASSERT_EQ(keys_.all().size(), 1U);
  EXPECT_EQ(keys_.all()[0].name, "ci");
  EXPECT_EQ(keys_.find(text)->id, keys_.all()[0].id);
  const std::string secret = text.substr(text.rfind('_') + 1);
  for (const auto& entry : std::filesystem::directory_iterator(dir_.path()))
    EXPECT_EQ(read_file(entry.path()).find(secret), std::string::npos) << entry.path();
}

TEST_F(Keys, HaveNamesThatAListCanShow) {
  for (const char* name : {"a\nk_1", "\x1b[2J", "tab\t", "\x7f"})
    EXPECT_EQ(error_of([&] { add(name, {.read = true}); }).code(), ErrorCode::invalid_option);
  EXPECT_NO_THROW(add("Ä ☺", {.read = true}));
}

TEST_F(Keys, OfAFileCountBesideTheOthersAndAreNotStored) {
  const std::string secret(32, 'k');
  write_file(dir_.path() / "secret", "\n" + secret + " \r\n");
  KeyStore keys(dir_.path(), dir_.path() / "secret");
  const std::string other = add("ci", {.read = true});
  ASSERT_TRUE(keys.find(secret));
  EXPECT_EQ(keys.find(secret)->id, "k_file");
  EXPECT_TRUE(keys.find(secret)->scopes.admin);
  EXPECT_TRUE(keys.find(other));
  EXPECT_FALSE(keys.find(secret + "k"));
  EXPECT_FALSE(keys.find(""));
  EXPECT_FALSE(keys_.find(secret));
  EXPECT_EQ(keys.all().size(), 1U);
}

TEST_F(Keys, OfAFileAreRefusedWhenTheyCouldBeGuessedOrSentByNobody) {
  for (const std::string& text :
       {std::string(), std::string(" \n"), std::string(31, 'k'), std::string(513, 'k'),
        std::string(20, 'k') + ' ' + std::string(20, 'k')}) {
    write_file(dir_.path() / "secret", text);
    const auto open = [&] { const KeyStore keys(dir_.path(), dir_.path() / "secret"); };
    EXPECT_EQ(error_of(open).code(), ErrorCode::invalid_option) << text;
  }
  const auto open = [&] { const KeyStore keys(dir_.path(), dir_.path() / "missing"); };
  EXPECT_EQ(error_of(open).code(), ErrorCode::storage_failed);
}

TEST_F(Keys, AreRefusedWithAnyCharacterChangedAndOnceRemoved) {
  const std::string text = add("ci", {.read = true});
  EXPECT_EQ(admit(text).owner, keys_.all()[0].id);
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string other = text;
    other[at] = other[at] == 'a' ? 'b' : 'a';
    EXPECT_EQ(error_of([&] { admit(other); }).code(), ErrorCode::unauthorized) << at;
  }
  EXPECT_EQ(error_of([&] { admit(""); }).code(), ErrorCode::unauthorized);
  EXPECT_TRUE(keys_.remove(keys_.all()[0].id));
  EXPECT_EQ(error_of([&] { admit(text); }).code(), ErrorCode::unauthorized);
}

TEST_F(Keys, DoWhatTheirScopesSayAndNoMore) {
  const std::string submit = add("s", {.submit = true});
  const std::string read = add("r", {.read = true});
  const std::string admin = add("a", {.admin = true});
  EXPECT_EQ(error_of([&] { admit(submit, "GET"); }).code(), ErrorCode::forbidden);
  for (const char* method : {"POST", "PUT", "DELETE"})
    EXPECT_EQ(error_of([&] { admit(read, method); }).code(), ErrorCode::forbidden) << method;
  EXPECT_FALSE(admit(submit, "POST").sees_all);
  EXPECT_FALSE(admit(read, "HEAD").sees_all);
  EXPECT_TRUE(admit(admin, "DELETE").sees_all);
  EXPECT_EQ(to_text(parse_scopes("read,submit")), "submit,read");
  EXPECT_EQ(to_text(parse_scopes("submit, read ")), "submit,read");
  for (const char* wrong : {"root", "", "read,", "read submit"})
    EXPECT_EQ(error_of([&] { parse_scopes(wrong); }).code(), ErrorCode::invalid_option) << wrong;
}

TEST(Links, AreNotSignedWithWhatIsLeftOfASecret) {
  const TempDir dir;
  write_file(dir.path() / "secret", "");
  EXPECT_EQ(error_of([&] { static_cast<void>(secret_in(dir.path() / "secret")); }).code(),
            ErrorCode::storage_failed);
}

/// The request that opens a link.
http::Request opening(const std::string& link) {
  http::Request request = request_of("GET", link.substr(0, link.find('?')));
  std::string query = link.substr(link.find('?') + 1) + "&lambda=1";
  for (std::size_t end = 0; !query.empty(); query.erase(0, end)) {
    const std::size_t equals = query.find('=');
    end = std::min(query.find('&'), query.size() - 1) + 1;
    const std::size_t last = query[end - 1] == '&' ? end - 1 : end;
    request.query.emplace(query.substr(0, equals), query.substr(equals + 1, last - equals - 1));
  }
  return request;
}

TEST_F(Keys, ALinkOpensItsOwnFileUntilItExpires) {
  constexpr std::int64_t kFarAway = 1'000'000'000'000;
  const http::Caller caller = admit(add("ci", {.read = true}));
  const LinkKey key{.id = caller.owner, .sha256 = caller.key_sha256};
  const std::string link = links_.sign("/v1/jobs/j_1/result", kFarAway, key);
  http::Request request = opening(link);
  access_.admit(request, "/v1/jobs/{id}/result");
  EXPECT_TRUE(request.caller.sees_all);
  EXPECT_EQ(request.query.size(), 1U) << "the handler does not see what signs the link";
  std::vector<http::Request> refused(4, opening(link));
  refused[0].path = "/v1/jobs/j_2/result";
  refused[1].method = "DELETE";
  refused[2].query.erase("expires");
  refused[3] = opening(links_.sign("/v1/jobs/j_1/result", 1'000'000'000, key));
  refused.push_back(
      opening(LinkSigner("another secret").sign("/v1/jobs/j_1/result", kFarAway, key)));
  refused.push_back(opening(links_.sign("/v1/jobs/j_1/result", kFarAway)));  // of no key
  refused.push_back(opening(link));
  refused.back().query.erase("key");
  for (http::Request& each : refused) {
    EXPECT_EQ(error_of([&] { access_.admit(each, "/v1/jobs/{id}/result"); }).code(),
              ErrorCode::invalid_link);
  }
}

TEST_F(Keys, ALinkGoesWithItsKeyAndNoOtherTakesItsPlace) {
  constexpr std::int64_t kFarAway = 1'000'000'000'000;
  const std::string path = "/v1/jobs/j_1/result";
  const auto open = [&](const LinkKey& key) {
    http::Request request = opening(links_.sign(path, kFarAway, key));
    access_.admit(request, "/v1/jobs/{id}/result");
  };
  const http::Caller caller = admit(add("ci", {.read = true}));
  const LinkKey key{.id = caller.owner, .sha256 = caller.key_sha256};
  EXPECT_NO_THROW(open(key));
  EXPECT_EQ(error_of([&] { open({.id = key.id, .sha256 = sha256("other")}); }).code(),
            ErrorCode::invalid_link);
  EXPECT_TRUE(keys_.remove(key.id));
  EXPECT_EQ(error_of([&] { open(key); }).code(), ErrorCode::invalid_link);
  Access keyless(keys_, links_, false);
  http::Request request = opening(links_.sign(path, kFarAway));
  EXPECT_NO_THROW(keyless.admit(request, "/v1/jobs/{id}/result"));
}

TEST_F(Keys, ATicketOpensOneCallForItsKeyWithAllThatIsSigned) {
  const http::Caller caller = admit(add("ci", {.submit = true}), "POST");
  const LinkKey key{.id = caller.owner, .sha256 = caller.key_sha256};
  const http::Ticket ticket{.id = "0af7", .max_bytes = 70, .expires = 1'000'000'000'000};
  http::Request request = opening(links_.sign(ticket, key));
  request.method = "POST";
  http::Request taken = request;
  access_.admit(taken, "/v1/jobs");
  ASSERT_TRUE(taken.ticket);
  EXPECT_EQ(taken.ticket->id, "0af7");
  EXPECT_EQ(taken.ticket->max_bytes, 70);
  EXPECT_EQ(taken.ticket->expires, ticket.expires);
  EXPECT_EQ(taken.caller.owner, caller.owner);
  EXPECT_FALSE(taken.caller.sees_all);
  EXPECT_EQ(taken.query.size(), 1U) << "options are left";
  std::vector<http::Request> refused(9, request);
  refused[0].method = "GET";
  refused[1].path = "/v1/jobs/events";
  for (std::size_t k = 0; const char* name : {"ticket", "max_bytes", "expires", "key", "signature"})
    refused[2 + k++].query.erase(name);
  refused[7].query.erase("max_bytes");
  refused[7].query.emplace("max_bytes", "700");
  refused[8].query.erase("max_bytes");  // a line of what is signed in another parameter
  refused[8].query.erase("ticket");
  refused[8].query.emplace("ticket", "0af7\n70");
  for (http::Request& each : refused) EXPECT_ANY_THROW(access_.admit(each, "/v1/jobs"));
  EXPECT_TRUE(keys_.remove(key.id));
  EXPECT_EQ(error_of([&] { access_.admit(request, "/v1/jobs"); }).code(), ErrorCode::invalid_link);
}

TEST_F(Keys, LinksAndLargePicturesCountForTheRateOfTheirKey) {
  ApiKey limited;
  limited.name = "ci";
  limited.scopes.read = true;
  limited.requests_per_minute = 20;
  const http::Caller caller = admit(keys_.add(limited));  // 1
  const LinkKey key{.id = caller.owner, .sha256 = caller.key_sha256};
  const auto open = [&](const std::string& size) {
    http::Request request =
        opening(links_.sign("/v1/jobs/j_1/preview.png", 1'000'000'000'000, key));
    if (!size.empty()) request.query.emplace("size", size);
    access_.admit(request, "/v1/jobs/{id}/preview.png");
  };
  EXPECT_NO_THROW(open("4096"));  // 16
  EXPECT_EQ(error_of([&] { open("4096"); }).code(), ErrorCode::rate_limited);
  for (const char* size : {"", "64", "1024"}) EXPECT_NO_THROW(open(size)) << size;
}

TEST(RateLimit, WhatCostsMoreThanAMinuteIsWorthComesThroughOnceAMinute) {
  RateLimit rates;
  const RateLimit::Clock::time_point start{};
  EXPECT_EQ(rates.wait_seconds("a", 6, start, 16), 0);
  EXPECT_EQ(rates.wait_seconds("a", 6, start, 16), 60);
  EXPECT_EQ(rates.wait_seconds("a", 6, start, 1), 10);
  EXPECT_EQ(rates.wait_seconds("a", 6, start + std::chrono::seconds(60), 16), 0);
}

TEST(Webhook, AreSignedAsStandardWebhooksHasIt) {  // the example of that specification
  EXPECT_EQ(
      webhooks::webhook_signature("whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw",
                                  "msg_p5jXN8AQM9LWM0D4loKWxJek.1614265330.{\"test\": 2432232314}"),
      "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=");
  EXPECT_NE(webhooks::webhook_secret("s", "k_a"), webhooks::webhook_secret("s", "k_b"));
  EXPECT_NO_THROW(webhooks::webhook_signature(webhooks::webhook_secret("s", "k_a"), "text"));
}

TEST(Cors, LetsOnlyPagesOfListedSitesIn) {
  const http::Cors cors({"https://a.example"});
  const auto allowed = [&](const std::string& origin) {
    http::Request request = request_of("OPTIONS", "/v1/jobs");
    request.headers.emplace("Origin", origin);
    request.headers.emplace("Access-Control-Request-Method", "POST");
    http::Response response;
    cors.allow(request, response);
    bool told = false;
    for (const auto& [name, value] : response.headers) told |= value == origin;
    EXPECT_EQ(told, cors.preflight(request).has_value()) << origin;
    return told;
  };
  EXPECT_TRUE(allowed("https://a.example"));
  EXPECT_FALSE(allowed("https://a.example.org"));
  EXPECT_FALSE(allowed("http://a.example"));
  EXPECT_FALSE(allowed("null"));
}

}  // namespace
}  // namespace unwrapd::server::access
