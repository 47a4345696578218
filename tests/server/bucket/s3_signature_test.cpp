// Signatures against the examples that Amazon publishes ("Signature Calculations for the
// Authorization Header" and "Authenticating Requests: Using Query Parameters"): the same key,
// requests and time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "server/base/identity.hpp"
#include "server/bucket/s3_signature.hpp"

namespace unwrapd::server::bucket {
namespace {

using namespace std::chrono_literals;

const Credentials kExample{.access_key = "AKIAIOSFODNN7EXAMPLE",
                           .secret_key = "wJalrXUtnFEMI/K7MDENG/bPxRfiCYEXAMPLEKEY"};

UnsignedRequest request(const std::string& method, const std::string& path,
                        const std::string& body = "") {
  return {.method = method,
          .host = "examplebucket.s3.amazonaws.com",
          .path = path,
          .query = {},
          .headers = {},
          .body_sha256 = sha256(body)};
}

std::string signature_of(const UnsignedRequest& request) {
  const auto lines = signed_headers(request, kExample, "us-east-1", "20130524T000000Z");
  return lines.back().substr(lines.back().rfind('=') + 1);
}

TEST(S3Signature, OfARangeOfAnObject) {
  UnsignedRequest get = request("GET", "/test.txt");
  get.headers["range"] = "bytes=0-9";
  EXPECT_EQ(signature_of(get), "f0e8bdb87c964420e857bd35b5d6ed310bd44f0170aba48dd91039c6036bdb41");
}

TEST(S3Signature, OfAnUploadWhoseKeyNeedsACode) {
  UnsignedRequest put = request("PUT", "/test$file.text", "Welcome to Amazon S3.");
  put.headers = {{"date", "Fri, 24 May 2013 00:00:00 GMT"},
                 {"x-amz-storage-class", "REDUCED_REDUNDANCY"}};
  EXPECT_EQ(signature_of(put), "98ad721746da40c64f1a55b78f14c238d841ea1380cd77a1b5971af0ece108bd");
}

TEST(S3Signature, OfQueries) {
  UnsignedRequest cycle = request("GET", "/");
  cycle.query = {{"lifecycle", ""}};
  EXPECT_EQ(signature_of(cycle),
            "fea454ca298b7da1c68078a5d1bdbfbbe0d65c699e0f91ac7a200a0136783543");
  UnsignedRequest list = request("GET", "/");
  list.query = {{"prefix", "J"}, {"max-keys", "2"}};
  EXPECT_EQ(signature_of(list), "34b48302e7b5fa45bde8084f4b7868a86f0a534bc59db6670ed5711ef69dc6f7");
}

TEST(S3Signature, TokensOfTemporaryKeysAreSent) {
  Credentials temporary = kExample;
  temporary.session_token = "token";
  const auto lines =
      signed_headers(request("GET", "/"), temporary, "eu-west-1", "20130524T000000Z");
  EXPECT_NE(std::find(lines.begin(), lines.end(), "x-amz-security-token: token"), lines.end());
  EXPECT_NE(lines.back().find("20130524/eu-west-1/s3/aws4_request,SignedHeaders="
                              "host;x-amz-content-sha256;x-amz-date;x-amz-security-token,"),
            std::string::npos);
}

TEST(S3Signature, OfALink) {
  const std::string query =
      signed_query(request("GET", "/test.txt"), kExample, "us-east-1", "20130524T000000Z", 24h);
  EXPECT_EQ(query,
            "X-Amz-Algorithm=AWS4-HMAC-SHA256&X-Amz-Credential=AKIAIOSFODNN7EXAMPLE%2F20130524%2F"
            "us-east-1%2Fs3%2Faws4_request&X-Amz-Date=20130524T000000Z&X-Amz-Expires=86400&"
            "X-Amz-SignedHeaders=host&X-Amz-Signature="
            "aeeed9bbccd4d02ee5c0109b86d86835f995330da4c265957d157751f604d404");
}

TEST(S3Signature, LinksHaveTheTokensOfTemporaryKeys) {
  Credentials temporary = kExample;
  temporary.session_token = "a/token=";
  const std::string query =
      signed_query(request("GET", "/"), temporary, "us-east-1", "20130524T000000Z", 5min);
  EXPECT_NE(query.find("&X-Amz-Security-Token=a%2Ftoken%3D&X-Amz-SignedHeaders="),
            std::string::npos);
}

TEST(S3Signature, TimesAreOfGreenwich) {
  EXPECT_EQ(signing_time(1'369'353'600), "20130524T000000Z");
}

TEST(S3Signature, BytesOfPathsAndQueriesHaveCodes) {
  EXPECT_EQ(encoded_path("/a b/\xC3\xBC-_.~"), "/a%20b/%C3%BC-_.~");
  EXPECT_EQ(encoded_query({{"prefix", "a/b"}, {"list-type", "2"}}), "list-type=2&prefix=a%2Fb");
}

}  // namespace
}  // namespace unwrapd::server::bucket
