// Answers whose body comes with time: one thread writes them all and waits for none.
#include "tests/server/http_server_fixture.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <thread>

namespace unwrapd::server::http {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr std::string_view kGet = "GET / HTTP/1.1\r\nHost: x\r\n\r\n";

/// What all streams tell: a text that grows, from its beginning, some of it at a time.
class Story {
 public:
  explicit Story(const Wakeup& bell) : bell_(bell) {}

  void tell(std::string_view more, bool end = false) {
    {
      const std::lock_guard lock(mutex_);
      text_ += more;
      end_ = end;
    }
    bell_.ring();
  }
  StreamPiece after(std::size_t& at) {
    const std::lock_guard lock(mutex_);
    asked = true;
    StreamPiece piece{.bytes = text_.substr(at, kMostBytes)};
    at += piece.bytes.size();
    told += piece.bytes.size();
    piece.end = end_ && at == text_.size();
    return piece;
  }

  std::atomic<int> open = 0;
  std::atomic<bool> asked = false;
  std::atomic<std::size_t> told = 0;  ///< bytes, to all

 private:
  static constexpr std::size_t kMostBytes = 4096;
  const Wakeup& bell_;
  std::mutex mutex_;
  std::string text_;
  bool end_ = false;
};

class StreamWriting : public HttpServerTest {
 protected:
  StreamWriting() {
    config_.max_requests = 1;
    answer_ = [this](const Request& request) {
      if (request.path != "/") return json_response(200, "\"plain\"");
      Response response;
      response.content_type = "text/event-stream";
      ++story_.open;
      const std::shared_ptr<std::size_t> at(new std::size_t(0), [this](std::size_t* gone) {
        delete gone;
        --story_.open;
      });
      response.body = StreamBody{.next = [this, at] { return story_.after(*at); }, .ping = ": p\n"};
      return response;
    };
  }
  ~StreamWriting() override { stop(); }

  [[nodiscard]] std::unique_ptr<RawClient> follow() const {
    auto client = connect();
    client->send(kGet);
    return client;
  }
  std::size_t observed() {
    const std::lock_guard lock(mutex_);
    return seen_.size();
  }

  Story story_{*news_};
};

TEST_F(StreamWriting, AHundredReadersHaveOneThreadAndOthersAreAnswered) {
  start();
  std::vector<std::unique_ptr<RawClient>> readers;
  for (int i = 0; i < 100; ++i) readers.push_back(follow());
  for (const auto& reader : readers) EXPECT_THAT(reader->read_until("\r\n\r\n"), HasSubstr("200"));
  await([&] { return story_.open == 100; });
  story_.tell("one");
  for (const auto& reader : readers) EXPECT_EQ(reader->read_until("one\r\n"), "3\r\none\r\n");
  const auto other = connect();
  other->send("GET /other HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(other->finish(), HasSubstr("plain"));
  story_.tell("two more", true);
  for (const auto& reader : readers)
    EXPECT_EQ(reader->read_until("0\r\n\r\n"), "8\r\ntwo more\r\n0\r\n\r\n");
  await([&] { return observed() == 101; });
  EXPECT_EQ(story_.open, 0);
}

TEST_F(StreamWriting, AReaderWhoTakesNothingIsNotFetchedForAndKeepsNobodyWaiting) {
  config_.limits.write = std::chrono::minutes(10);
  start();
  const auto slow = follow();
  await([&] { return story_.asked.load(); });
  const std::string much(std::size_t{16} << 20, 'x');
  story_.tell(much, true);
  const auto quick = follow();
  EXPECT_GT(quick->read_until("\r\n0\r\n\r\n").size(), much.size());
  EXPECT_LT(story_.told, 2 * much.size());  // of which all were for the quick one
  EXPECT_GT(slow->read_until("\r\n0\r\n\r\n").size(), much.size());  // it has lost nothing
}

TEST_F(StreamWriting, AReaderWhoTakesNothingForLongIsCutOff) {
  config_.limits.write = milliseconds(100);
  start();
  const auto slow = follow();
  story_.tell(std::string(std::size_t{16} << 20, 'x'));
  await([&] { return observed() == 1; });
  EXPECT_EQ(story_.open, 0);
  EXPECT_THAT(slow->read_to_end(), Not(EndsWith("0\r\n\r\n")));
  EXPECT_GT(seen_.front().sent_bytes, 4096);
  EXPECT_EQ(seen_.front().status, 200);
}

TEST_F(StreamWriting, AReaderWhoIsAllInAllTooSlowIsCutOff) {
  config_.limits.rate_grace = milliseconds(100);
  config_.limits.min_bytes_per_second = std::int64_t{1} << 40;
  start();
  const auto slow = follow();
  story_.tell(std::string(std::size_t{16} << 20, 'x'));
  std::jthread sip([&](const std::stop_token& stop) {
    while (!stop.stop_requested() && !slow->read_until("x").empty())
      std::this_thread::sleep_for(milliseconds(1));
  });
  await([&] { return observed() == 1; });
}

TEST_F(StreamWriting, SilenceIsFilledWithPings) {
  config_.ping = milliseconds(20);
  start();
  const auto reader = follow();
  reader->read_until("\r\n\r\n");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(reader->read_until("\n\r\n"), "4\r\n: p\n\r\n");
}

TEST_F(StreamWriting, AfterTheEndTheConnectionTakesAnotherRequest) {
  start();
  story_.tell("all", true);
  const auto reader = connect();
  reader->send(std::string(kGet) + "GET /other HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  const std::string all = reader->read_to_end();
  EXPECT_THAT(all, AllOf(HasSubstr("all\r\n0\r\n\r\nHTTP/1.1 200"), EndsWith("\"plain\"")));
}

TEST_F(StreamWriting, WhoAskedForTheEndOfTheConnectionGetsIt) {
  config_.idle_connections.idle = std::chrono::hours(1);
  start();
  story_.tell("all", true);
  const auto reader = connect();
  reader->send("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(reader->read_until("0\r\n\r\n"), EndsWith("all\r\n0\r\n\r\n"));
  await([&] { return server_->open() == 0; });
}

TEST_F(StreamWriting, ForHttp10IsTheBodyAsItIsAndEndsWithTheConnection) {  // RFC 9112, 6.1
  config_.idle_connections.idle = std::chrono::hours(1);
  start();
  story_.tell("all");
  const auto reader = connect();
  reader->send("GET / HTTP/1.0\r\nConnection: Keep-Alive\r\n\r\n");
  const std::string head = reader->read_until("\r\n\r\n");
  EXPECT_THAT(head, AllOf(Not(HasSubstr("Transfer-Encoding")), HasSubstr("Connection: close")));
  EXPECT_EQ(reader->read_until("all"), "all");
  story_.tell(" and the end", true);
  EXPECT_EQ(reader->read_until(" end"), " and the end");
  await([&] { return server_->open() == 0; });
}

TEST_F(StreamWriting, WhoLeavesIsLetGoAtOnce) {
  start();
  auto reader = follow();
  reader->read_until("\r\n\r\n");
  await([&] { return story_.open == 1; });
  reader.reset();
  await([&] { return story_.open == 0 && server_->open() == 0; });
  EXPECT_EQ(observed(), 1U);
}

TEST_F(StreamWriting, ABodyThatFailsCostsItsOwnStream) {
  answer_ = [](const Request& request) {
    Response response;
    response.body = StreamBody{.next = [fails = request.path == "/"]() -> StreamPiece {
      if (fails) throw std::bad_alloc();
      return {.bytes = "fine", .end = true};
    }};
    return response;
  };
  start();
  EXPECT_THAT(follow()->read_to_end(), EndsWith("\r\n\r\n"));
  const auto other = connect();
  other->send("GET /other HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(other->read_until("0\r\n\r\n"), HasSubstr("fine"));
}

TEST_F(StreamWriting, StreamsThatDoNotEndDoNotHoldUpTheEnd) {
  config_.last_answers = milliseconds(50);
  start();
  const auto reader = follow();
  reader->read_until("\r\n\r\n");
  stop();
  EXPECT_THAT(reader->read_to_end(), IsEmpty());
  EXPECT_EQ(observed(), 1U);
  EXPECT_EQ(story_.open, 0);
}

TEST_F(StreamWriting, GoesThroughTls) {
  const TempDir dir;
  config_.tls_certificate = dir.path() / "cert.pem";
  config_.tls_key = dir.path() / "key.pem";
  write_certificate(config_.tls_certificate, config_.tls_key);
  start();
  const std::string much(std::size_t{8} << 20, 'x');
  std::atomic<bool> begun = false;
  std::string got;
  std::jthread reader([&] {
    httplib::SSLClient client("127.0.0.1", server_->port());
    client.enable_server_certificate_verification(false);
    client.set_read_timeout(std::chrono::minutes(2));
    client.Get("/", [&](const char* data, std::size_t size) {
      if (!begun) std::this_thread::sleep_for(milliseconds(200));  // now it has to wait for us
      begun = true;
      got.append(data, size);
      return true;
    });
  });
  await([&] { return story_.open == 1; });
  story_.tell(much);
  await([&] { return begun.load(); });
  story_.tell("end", true);
  reader.join();
  EXPECT_EQ(got, much + "end");
}

}  // namespace
}  // namespace unwrapd::server::http
