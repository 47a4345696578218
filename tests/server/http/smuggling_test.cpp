// Shapes by which one request is made to look like two, or two like one, to
// programs that read HTTP differently; and the memory of a large upload.
#include "tests/server/running_server.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/samples/sanitized.hpp"
#include "tests/server/raw_client.hpp"

namespace unwrapd::server::http {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kHidden = "GET /v1/limits HTTP/1.1\r\nHost: x\r\n\r\n";

struct Shape {
  const char* name;
  std::string head;       // without its last empty line
  std::string body = {};  // the hidden request follows
};

std::vector<Shape> shapes() {
  const std::string post = "POST /v1/jobs HTTP/1.1\r\nHost: x\r\n";
  const std::string chunked = "Transfer-Encoding: chunked\r\n";
  return {
      {"both framings", post + "Content-Length: 5\r\n" + chunked, "0\r\n\r\n"},
      {"both, the other way round", post + chunked + "Content-Length: 5\r\n", "0\r\n\r\n"},
      {"two lengths", post + "Content-Length: 0\r\nContent-Length: 5\r\n"},
      {"the same length twice", post + "Content-Length: 0\r\nContent-Length: 0\r\n"},
      {"a list of lengths", post + "Content-Length: 0, 0\r\n"},
      {"a signed length", post + "Content-Length: +0\r\n"},
      {"a hexadecimal length", post + "Content-Length: 0x0\r\n"},
      {"an empty length", post + "Content-Length: \r\n"},
      {"a length beyond 64 bits", post + "Content-Length: 18446744073709551616\r\n"},
      {"a space before the colon", post + "Content-Length : 0\r\n"},
      {"a tab before the colon", post + "Transfer-Encoding\t: chunked\r\n", "0\r\n\r\n"},
      {"two codings", post + "Transfer-Encoding: identity, chunked\r\n", "0\r\n\r\n"},
      {"the coding twice", post + chunked + chunked, "0\r\n\r\n"},
      {"an unknown coding", post + "Transfer-Encoding: xchunked\r\n", "0\r\n\r\n"},
      {"a quoted coding", post + "Transfer-Encoding: \"chunked\"\r\n", "0\r\n\r\n"},
      {"a coding after a vertical tab",
       post + "Transfer-Encoding: \x0b"
              "chunked\r\n",
       "0\r\n\r\n"},
      {"a folded coding", post + "Transfer-Encoding:\r\n chunked\r\n", "0\r\n\r\n"},
      {"a coding in HTTP/1.0", "POST /v1/jobs HTTP/1.0\r\n" + chunked, "0\r\n\r\n"},
      {"a field after a bare line feed", post + "X: y\nTransfer-Encoding: chunked\r\n",
       "0\r\n\r\n"},
      {"a field after a bare return", post + "X: y\rContent-Length: 0\r\n"},
      {"a null in a field", post + std::string("X: a\0b\r\n", 8) + "Content-Length: 0\r\n"},
      {"a field without a colon", post + "Content-Length\r\n"},
      {"a folded first field", "POST /v1/jobs HTTP/1.1\r\n Host: x\r\nContent-Length: 0\r\n"},
      {"two hosts", post + "Host: y\r\nContent-Length: 0\r\n"},
      {"a version of ours and another",
       "POST /v1/jobs HTTP/1.1 HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\n"},
      {"a small version", "POST /v1/jobs http/1.1\r\nHost: x\r\nContent-Length: 0\r\n"},
      {"a tunnel", "CONNECT x:1 HTTP/1.1\r\nHost: x\r\n"},
      {"a method that httplib does not know", "FOO /healthz HTTP/1.1\r\nHost: x\r\n"},
      {"a field longer than httplib reads",
       "GET /healthz HTTP/1.1\r\nHost: x\r\nX: " + std::string(9000, 'a') + "\r\nY: z\r\n"},
      {"a body that nobody reads", "GET /healthz HTTP/1.1\r\nHost: x\r\nContent-Length: 38\r\n"},
      {"a chunk size with a prefix", post + chunked, "0x0\r\n\r\n"},
      {"a chunk size with a sign", post + chunked, "-0\r\n\r\n"},
      {"a chunk size and a word", post + chunked, "0 0\r\n\r\n"},
      {"a line feed in a chunk's extension", post + chunked, "2;\nxx\r\nab\r\n0\r\n\r\n"},
      {"a chunk longer than it says", post + chunked, "1\r\nabc\r\n0\r\n\r\n"},
      {"a chunk that ends with a line feed", post + chunked, "1\r\na\n0\r\n\r\n"},
      {"a trailer that never ends", post + chunked, "0\r\nX: y\r\n"},
      {"trailers that end with line feeds", post + chunked, "0\r\nX: y\n\n"},
      {"a bare return in a trailer", post + chunked, "0\r\nX: y\rZ: z\r\n\r\n"},
      {"a null in a trailer", post + chunked, std::string("0\r\nX\0: y\r\n\r\n", 12)},
      {"a space before a trailer's colon", post + chunked, "0\r\nX : y\r\n\r\n"},
      {"a folded trailer", post + chunked, "0\r\n X: y\r\n\r\n"},
      {"a trailer without a name", post + chunked, "0\r\n: y\r\n\r\n"},
      {"a request as a trailer", post + chunked, "0\r\nGET / x: 1\r\n\r\n"},
      {"a length as a trailer", post + chunked, "0\r\nContent-Length: 5\r\n\r\n"},
      {"a body of no length", post},
      {"two types",
       post + "Content-Length: 0\r\nContent-Type: model/obj\r\nContent-Type: text/csv\r\n"},
      {"a word among the fields", post + "Content-Length: 0\r\nX\r\n"},
  };
}

class Smuggling : public RunningServer {};

TEST_F(Smuggling, NoShapeIsAnsweredTwice) {
  start();
  for (const Shape& shape : shapes()) {
    const RawClient raw(service_->port());
    raw.send(shape.head + "\r\n" + shape.body + kHidden);
    const std::string answer = raw.finish();
    EXPECT_THAT(answer, testing::StartsWith("HTTP/1.1 ")) << shape.name;
    EXPECT_THAT(answer, Not(HasSubstr("max_body_bytes"))) << shape.name << ": " << answer;
    EXPECT_THAT(answer, Not(HasSubstr("}HTTP/1.1 "))) << shape.name;  // a second answer
    EXPECT_THAT(answer, HasSubstr("Connection: close")) << shape.name;
    const bool is_unread_body = answer.starts_with("HTTP/1.1 200");
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 4") || is_unread_body) << shape.name << answer;
  }
}

TEST_F(Smuggling, WithoutAnyTrickTheSecondRequestIsAnswered) {
  start();
  const RawClient raw(service_->port());
  raw.send("GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n" + kHidden);
  EXPECT_THAT(raw.finish(), HasSubstr("max_body_bytes"));
}

/// VmHWM or VmRSS in bytes.
std::int64_t memory(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name)) return std::stoll(line.substr(name.size() + 1)) * 1024;
  return 0;
}

TEST_F(Smuggling, AHundredMegabytesAreReceivedInAFewOfMemory) {
  if (is_sanitized()) GTEST_SKIP() << "a sanitizer keeps freed memory and shadows of its own";
  config_.workers = 1;
  start();
  const std::string busy = submit_endless();  // so that nobody reads the upload
  await([&] {                                 // and it has what memory it takes
    return job(busy).value(api::Json::json_pointer("/progress/iteration"), 0) > 0;
  });
  const std::size_t size = 100'000'000;
  const std::string piece = "# " + std::string(65'533, '.') + "\n";
  std::ofstream("/proc/self/clear_refs") << "5";  // the high-water mark begins anew
  const std::int64_t before = memory("VmRSS:");
  const auto answer = client().Post(
      "/v1/jobs", size,
      [&](std::size_t at, std::size_t, httplib::DataSink& sink) {
        return sink.write(piece.data(), std::min(piece.size(), size - at));
      },
      "model/obj");
  const std::int64_t grown = memory("VmHWM:") - before;
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 202);
  EXPECT_LE(grown, 16'000'000);
  RecordProperty("grown_bytes", std::to_string(grown));
  client().Delete("/v1/jobs/" + std::string(api::Json::parse(answer->body).at("id")));
  client().Delete("/v1/jobs/" + busy);
}

}  // namespace
}  // namespace unwrapd::server::http
