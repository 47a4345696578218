// The names of buckets and their servers, and where the key comes from.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/base/error.hpp"
#include "server/base/files.hpp"
#include "server/bucket/bucket_config.hpp"
#include "server/bucket/bucket_link.hpp"
#include "server/bucket/xml_texts.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::bucket {
namespace {

TEST(BucketConfig, NamesAreOfLettersThatNeedNoCode) {
  for (const char* good : {"s3://jobs", "s3://jobs/a/b_c.d", "s3://jobs/prefix/"})
    EXPECT_TRUE(is_bucket_url(good)) << good;
  for (const char* bad : {"", "s3://", "s3:///a", "s3://jobs//a", "s3://jobs/../a", "s3://jobs/a b",
                          "s3://jobs/a?b", "http://jobs"})
    EXPECT_FALSE(is_bucket_url(bad)) << bad;
  for (const char* good : {"https://s3.example.com", "http://[::1]:9000", "http://127.0.0.1:80"})
    EXPECT_TRUE(is_endpoint(good)) << good;
  for (const char* bad :
       {"", "s3.example.com", "https://", "https://a/b", "https://u@a", "ftp://a", "https://a;b"})
    EXPECT_FALSE(is_endpoint(bad)) << bad;
}

TEST(BucketConfig, AnAddressHasItsParts) {
  const TempDir dir;
  write_file(dir.path() / "key", "ID\nSECRET\n");
  BucketConfig config{.url = "s3://jobs/a/b",
                      .endpoint = "http://localhost:9000",
                      .region = "eu-west-1",
                      .credentials = dir.path() / "key"};
  const BucketAddress address = address_of(config);
  EXPECT_EQ(address.scheme, "http");
  EXPECT_EQ(address.host, "localhost:9000");
  EXPECT_EQ(address.bucket, "jobs");
  EXPECT_EQ(address.prefix, "a/b/");
  EXPECT_EQ(address.credentials.access_key, "ID");
  EXPECT_EQ(address.credentials.secret_key, "SECRET");
  config.endpoint.clear();
  EXPECT_EQ(address_of(config).host, "s3.eu-west-1.amazonaws.com");
}

TEST(BucketConfig, LinksHaveTheEndpointOfClients) {
  const TempDir dir;
  write_file(dir.path() / "key", "ID\nSECRET\n");
  BucketConfig config{
      .url = "s3://jobs/a", .endpoint = "http://inside:9000", .credentials = dir.path() / "key"};
  const LinkTerms terms{
      .method = "GET", .content_type = "model/obj", .cache_control = "private, a"};
  const auto link = [&] { return link_to(address_of(config), "j_1/result.obj", terms); };
  EXPECT_TRUE(link().starts_with("http://inside:9000/jobs/a/j_1/result.obj?X-Amz-")) << link();
  config.redirect_endpoint = "https://files.example.com:443";
  EXPECT_TRUE(link().starts_with("https://files.example.com/jobs/a/j_1/")) << "clients send no 443";
  EXPECT_EQ(address_of(config).host, "inside:9000");
  EXPECT_NE(link().find("&response-cache-control=private%2C%20a&response-content-type=model%2Fobj&"
                        "X-Amz-Signature="),
            std::string::npos)
      << link();
}

TEST(BucketConfig, WithoutAKeyNothingStarts) {
  const TempDir dir;
  write_file(dir.path() / "key", "ID\n");
  ::unsetenv("AWS_ACCESS_KEY_ID");
  BucketConfig config;
  config.url = "s3://jobs";
  const auto read = [&] { static_cast<void>(address_of(config)); };
  EXPECT_EQ(error_of(read).code(), ErrorCode::invalid_option);
  config.credentials = dir.path() / "key";
  EXPECT_EQ(error_of(read).code(), ErrorCode::invalid_option);
}

TEST(XmlTexts, AreWhatIsBetweenTags) {
  const std::string xml = "<a><Key>x&amp;y</Key><Key>&lt;z&gt;</Key><Key>open</a>";
  EXPECT_EQ(texts_of(xml, "Key"), (std::vector<std::string>{"x&y", "<z>"}));
  EXPECT_EQ(first_text(xml, "Code"), "");
}

}  // namespace
}  // namespace unwrapd::server::bucket
