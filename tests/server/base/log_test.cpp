// Log lines, and the names that the server makes.
#include "server/base/log.hpp"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "server/base/clock.hpp"
#include "server/base/identity.hpp"
#include "server/http/router.hpp"

namespace unwrapd::server {
namespace {

TEST(Log, EveryLineIsOneJsonObjectWhateverItSays) {
  testing::internal::CaptureStderr();
  const Log log(LogLevel::info);
  const std::string nasty = "a\n\"b\"\\ \x01 \xff {}%s";
  log.info(nasty, {{"job", "j_1"}, {"reason", nasty}});
  log.debug("too quiet");
  log.error("plain");
  std::istringstream lines(testing::internal::GetCapturedStderr());
  std::vector<api::Json> parsed;
  for (std::string line; std::getline(lines, line);) parsed.push_back(api::Json::parse(line));
  ASSERT_EQ(parsed.size(), 2U);
  EXPECT_EQ(parsed[0].at("level"), "info");
  EXPECT_EQ(parsed[0].at("job"), "j_1");
  EXPECT_EQ(parsed[0].at("event").get<std::string>().substr(0, 8), nasty.substr(0, 8));
  EXPECT_EQ(parsed[1].at("level"), "error");
}

TEST(Log, OfServerErrorsLeavesOutThatAKeyHasUsedUpItsQuota) {
  testing::internal::CaptureStderr();
  const Log log(LogLevel::info);
  const auto fail = [&log](ErrorCode code) {
    const http::Handler handler = [code](const http::Request&) -> http::Response {
      throw Error(code, "why");
    };
    http::Request request;
    request.method = "GET";
    request.path = "/";
    return http::Router({{"GET", "/", handler}}, log).answer(request).status;
  };
  EXPECT_EQ(fail(ErrorCode::quota_exceeded), 507);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  testing::internal::CaptureStderr();
  EXPECT_EQ(fail(ErrorCode::storage_full), 507);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("request failed"), std::string::npos);
}

TEST(Clock, WritesRfc3339InUtc) {
  EXPECT_EQ(rfc3339(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(rfc3339(1'772'323'199'007), "2026-02-28T23:59:59.007Z");
}

TEST(Identity, IdsAreWellFormedAndNeverTheSame) {
  std::set<std::string> ids;
  for (int k = 0; k < 1000; ++k) {
    const std::string id = random_job_id();
    EXPECT_TRUE(is_job_id(id)) << id;
    ids.insert(id);
  }
  EXPECT_EQ(ids.size(), 1000U);
  for (const char* other :
       {"", "j_", "j_0123456789abcdef0123456789abcde", "../../etc/passwd",
        "j_0123456789ABCDEF0123456789ABCDEF", "j_0123456789abcdef0123456789abcdef0"})
    EXPECT_FALSE(is_job_id(other)) << other;
}

TEST(Identity, Sha256IsTheStandardOne) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Sha256 pieces;
  for (const char* piece : {"a", "", "bc"}) pieces.add(piece);
  EXPECT_EQ(pieces.finish(), sha256("abc"));
}

}  // namespace
}  // namespace unwrapd::server
