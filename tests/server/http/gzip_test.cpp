// gzip both ways on a real server: zlib itself makes the bodies and reads the answers.
#include "server/http/gzip.hpp"

#include <gmock/gmock.h>
#include <zlib.h>

#include <array>
#include <random>

#include "server/base/identity.hpp"
#include "server/http/media_types.hpp"
#include "tests/server/raw_client.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::http {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::size_t kRoom = std::size_t{64} << 20;

std::string zipped(std::string bytes) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string unzipped(std::string bytes) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 16 + MAX_WBITS), Z_OK);
  std::string out(kRoom, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  EXPECT_EQ(stream.avail_in, 0U);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

/// Lines of an OBJ that no coder finds short.
std::string noise(std::size_t size) {
  std::mt19937 random(1);
  std::string text(size, ' ');
  for (char& c : text) c = static_cast<char>('0' + random() % 60);
  return text;
}

class Gzip : public RunningServer {
 protected:
  httplib::Result send(const std::string& path, const std::string& body,
                       const std::string& coding = "gzip") {
    return client().Post(path.c_str(), {{"Content-Encoding", coding}}, body, "model/obj");
  }
  httplib::Result put(const std::string& mesh, const std::string& body) {
    const std::string path = "/v1/meshes/" + sha256(mesh);
    return client().Put(path.c_str(), {{"Content-Encoding", "gzip"}}, body, "model/obj");
  }
  /// The answer as it comes: httplib would decode it.
  std::string raw_get(const std::string& path, const std::string& fields,
                      const std::string& method = "GET") {
    const RawClient raw(service_->port());
    raw.send(method + " " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + fields +
             "\r\n");
    return raw.read_to_end();  // who closes first has left, and nothing is made for them
  }
};

std::string head_of(const std::string& answer) { return answer.substr(0, answer.find("\r\n\r\n")); }

std::string field(const std::string& answer, const std::string& name) {
  const std::string head = head_of(answer) + "\r\n";
  const std::size_t at = head.find("\r\n" + name + ": ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 4;
  return head.substr(begin, head.find("\r\n", begin) - begin);
}

std::string body_of(const std::string& answer) {
  std::string rest = answer.substr(answer.find("\r\n\r\n") + 4);
  if (field(answer, "Transfer-Encoding") != "chunked") return rest;
  std::string body;
  for (std::size_t at = 0; at < rest.size();) {
    const std::size_t line = rest.find("\r\n", at);
    const std::size_t size = std::stoul(rest.substr(at, line - at), nullptr, 16);
    if (size == 0) break;
    body += rest.substr(line + 2, size);
    at = line + 2 + size + 2;
  }
  return body;
}

TEST_F(Gzip, AnUploadIsWhatItUnpacksTo) {
  start();
  const std::string mesh = grid_obj(30);
  const std::string half = mesh.substr(0, mesh.size() / 2);
  for (const std::string& body :
       {zipped(mesh), zipped(half) + zipped(mesh.substr(half.size()))}) {  // members follow
    const auto answer = put(mesh, body);
    ASSERT_THAT(answer->status, testing::AnyOf(200, 201)) << answer->body;
    EXPECT_EQ(api::Json::parse(answer->body).at("bytes"), mesh.size());
  }
  const auto job = send("/v1/jobs?preset=chart", zipped(mesh));
  ASSERT_EQ(job->status, 202) << job->body;
  const std::string id = api::Json::parse(job->body).at("id");
  await_state(id, "succeeded");
  const auto report = api::Json::parse(get(id, "report")->body);
  EXPECT_EQ(report.at("input").at("bytes"), mesh.size());
  EXPECT_EQ(report.at("input").at("sha256"), sha256(mesh));
}

TEST_F(Gzip, ACallForTheResultGetsItSo) {
  start();
  const auto answer = [&](const std::string& coding) {
    const RawClient raw(service_->port());
    const std::string body = zipped(grid_obj(20));
    raw.send("POST /v1/unwrap?preset=chart HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + coding +
             "Content-Encoding: gzip\r\nContent-Type: model/obj\r\nContent-Length: " +
             std::to_string(body.size()) + "\r\n\r\n" + body);
    return raw.finish();
  };
  const std::string plain = answer(""), gzip = answer("Accept-Encoding: gzip\r\n");
  EXPECT_THAT(plain, StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(field(gzip, "Content-Encoding"), "gzip");
  EXPECT_TRUE(unzipped(body_of(gzip)) == body_of(plain));
  EXPECT_EQ(field(plain, "Vary"), "Accept, Accept-Encoding");
}

TEST_F(Gzip, LimitsHoldForWhatIsUnpacked) {
  config_.limits.max_body_bytes = 1'000'000;
  start();
  const std::string fits = noise(1'000'000);
  EXPECT_EQ(put(fits, zipped(fits))->status, 201);
  const std::string over = noise(1'000'001);
  ASSERT_LT(zipped(over).size(), 1'000'000U);
  expect_problem(put(over, zipped(over)), 413, "body_too_large");
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
}

TEST_F(Gzip, ABombIsRefusedLongBeforeTheLimit) {
  config_.limits.max_body_bytes = std::int64_t{1} << 30;
  start();
  const std::string bomb = zipped(std::string(kRoom, 'v'));
  ASSERT_LT(bomb.size(), kRoom / 500);
  const auto answer = send("/v1/jobs", bomb);
  expect_problem(answer, 413, "body_too_large");
  EXPECT_THAT(answer->body, HasSubstr("100 times"));
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path() / "incoming"));
}

TEST(GzipDecoder, HandsOutNoMoreOfABombThanItMay) {
  const std::string bomb = zipped(std::string(kRoom, 'v'));
  std::int64_t came = 0;
  GzipDecoder decoder(std::int64_t{1} << 40, [&](std::string_view bytes) {
    came += std::ssize(bytes);
    ASSERT_LE(bytes.size(), std::size_t{1} << 16);
  });
  EXPECT_THROW(decoder.feed(bomb), Error);
  EXPECT_LE(came, kFreeUnpackedBytes);
}

TEST(GzipDecoder, IsTheSameHoweverTheBodyIsCut) {
  const std::string text = noise(300'000) + std::string(300'000, 'x');
  const std::string body = zipped(text);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{1000}, body.size()}) {
    std::string came;
    GzipDecoder decoder(1'000'000, [&](std::string_view bytes) { came += bytes; });
    for (std::size_t at = 0; at < body.size(); at += piece)
      decoder.feed(std::string_view(body).substr(at, piece));
    decoder.finish();
    EXPECT_TRUE(came == text) << piece;
  }
}

TEST_F(Gzip, BrokenBodiesAndOtherCodingsAreRefused) {
  start();
  const std::string good = zipped(grid_obj(5));
  for (const std::string& body : {good.substr(0, good.size() - 3), std::string("v 0 0 0\n"),
                                  good + "v 0 0 0\n", std::string()})
    expect_problem(send("/v1/jobs", body), 400, "malformed_request");
  std::string damaged = good;
  damaged[damaged.size() - 6] ^= 1;  // of the check sum
  expect_problem(send("/v1/jobs", damaged), 400, "malformed_request");
  const auto other = send("/v1/jobs", good, "br");
  expect_problem(other, 415, "unsupported_media_type");
  EXPECT_EQ(other->get_header_value("Accept-Encoding"), "gzip");
  const auto type = client().Post("/v1/jobs", "x", "text/plain");
  expect_problem(type, 415, "unsupported_media_type");
  EXPECT_FALSE(type->has_header("Accept-Encoding"));  // which is not what it lacks
}

TEST_F(Gzip, AResultIsTheSameEitherWayUnderTagsOfItsOwn) {
  start();
  const std::string id = submit("", 40);
  await_state(id, "succeeded");
  for (const char* type : {"model/obj", "model/gltf+json", "model/gltf-binary"}) {
    const std::string path = "/v1/jobs/" + id + "/result";
    const std::string accept = std::string("Accept: ") + type + "\r\n";
    const std::string plain = raw_get(path, accept);
    const std::string gzip = raw_get(path, accept + "Accept-Encoding: br, gzip\r\n");
    EXPECT_EQ(field(plain, "Content-Encoding"), "");
    EXPECT_EQ(field(gzip, "Content-Encoding"), "gzip");
    EXPECT_TRUE(unzipped(body_of(gzip)) == body_of(plain)) << type;
    EXPECT_LT(body_of(gzip).size(), body_of(plain).size());
    for (const std::string& answer : {plain, gzip})
      EXPECT_EQ(field(answer, "Vary"), "Accept, Accept-Encoding");
    EXPECT_EQ(field(gzip, "ETag"), gzip_etag(field(plain, "ETag")));
    for (const std::string& tag : {field(plain, "ETag"), field(gzip, "ETag")}) {
      const std::string copy =
          raw_get(path, accept + "Accept-Encoding: gzip\r\nIf-None-Match: " + tag + "\r\n");
      EXPECT_THAT(copy, StartsWith("HTTP/1.1 304"));
      EXPECT_EQ(field(copy, "ETag"), tag);
      EXPECT_EQ(field(copy, "Vary"), "Accept, Accept-Encoding");
    }
  }
}

TEST_F(Gzip, RangesAreOfThePlainBytes) {
  start();
  const std::string id = submit("", 40);
  await_state(id, "succeeded");
  const std::string path = "/v1/jobs/" + id + "/result";
  const std::string plain = raw_get(path, "");
  const std::string range = "Accept-Encoding: gzip\r\nRange: bytes=100-4099\r\n";
  const std::string part = raw_get(path, range);
  EXPECT_THAT(part, StartsWith("HTTP/1.1 206"));
  EXPECT_EQ(body_of(part), body_of(plain).substr(100, 4000));
  EXPECT_EQ(field(part, "ETag"), field(plain, "ETag"));
  const std::string other = gzip_etag(field(plain, "ETag"));
  EXPECT_THAT(raw_get(path, range + "If-Range: " + other + "\r\n"),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("Content-Encoding: gzip")));
}

TEST_F(Gzip, OnlyWhatGainsIsCompressedAndOnlyForWhoAsks) {
  start();
  const std::string id = submit("", 20);
  await_state(id, "succeeded");
  const std::string gzip = "Accept-Encoding: gzip\r\n";
  EXPECT_EQ(field(raw_get("/v1/jobs/" + id + "/layout.png", gzip), "Content-Encoding"), "");
  EXPECT_EQ(field(raw_get("/v1/jobs/" + id + "/events", gzip), "Content-Encoding"), "");
  EXPECT_EQ(field(raw_get("/healthz", gzip), "Content-Encoding"), "");
  for (const std::string path : {"/v1/methods", "/", "/openapi.yaml"}) {
    EXPECT_TRUE(unzipped(body_of(raw_get(path, gzip))) == body_of(raw_get(path, ""))) << path;
    EXPECT_EQ(field(raw_get(path, "Accept-Encoding: gzip;q=0, *\r\n"), "Content-Encoding"), "");
    EXPECT_EQ(field(raw_get(path, ""), "Vary"), "Accept-Encoding") << path;
  }
  const std::string head = raw_get("/v1/methods", gzip, "HEAD");
  EXPECT_EQ(field(head, "Content-Encoding"), "gzip");
  EXPECT_EQ(body_of(head), "");
  const RawClient old(service_->port());
  old.send("GET /v1/methods HTTP/1.0\r\nHost: x\r\n" + gzip + "\r\n");
  const std::string plain = old.finish();
  EXPECT_EQ(field(plain, "Content-Encoding"), "");  // as of HTTP/1.0, which knows no chunks
  EXPECT_TRUE(body_of(plain) == body_of(raw_get("/v1/methods", "")));
  const std::string whole = raw_get("/v1/jobs/" + id + "/result", gzip, "HEAD");
  EXPECT_THAT(whole, StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(field(whole, "Content-Encoding"), "gzip");
}

TEST(MediaTypes, GzipIsTakenWhereItIsWanted) {
  for (const char* yes : {"gzip", "x-gzip", "GZIP", "br, gzip;q=0.5", "*", "gzip, identity"})
    EXPECT_TRUE(accepts_gzip(yes)) << yes;
  for (const char* no :
       {"", "br", "gzip;q=0", "identity", "*;q=0", "gzip;q=0, *", "gzip;q=0.5, identity;q=0.8"})
    EXPECT_FALSE(accepts_gzip(no)) << no;
}

TEST(MediaTypes, OtherCodingsAreTakenInTheSameWay) {
  EXPECT_TRUE(accepts_coding("gzip, deflate, br", "br"));
  EXPECT_FALSE(accepts_coding("gzip, br;q=0", "br"));
  EXPECT_FALSE(accepts_coding("gzip", "br"));
}

}  // namespace
}  // namespace unwrapd::server::http
