// Heads of requests: what is fine passes, and what two readers could read differently does not.
#include "server/http/http_head.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <tuple>

#include "core/base/error.hpp"

namespace unwrapd::server::http {
namespace {

std::string head(const std::string& line, const std::string& fields = "") {
  return line + "\r\nHost: x\r\n" + fields + "\r\n";
}

/// The code of the error, or nothing when the head passes.
std::optional<ErrorCode> refusal(const std::string& text) {
  try {
    const Framing framing = vet_head(text);
    return framing.refusal ? std::optional(framing.refusal->code()) : std::nullopt;
  } catch (const Error& error) {
    return error.code();
  }
}

const std::string kPost = "POST /v1/jobs HTTP/1.1";

TEST(HttpHead, ReadsTheFraming) {
  EXPECT_FALSE(vet_head(head("GET / HTTP/1.1")).has_body());
  EXPECT_FALSE(vet_head(head(kPost, "Content-Length: 0\r\n")).has_body());
  EXPECT_EQ(vet_head(head(kPost, "content-length:  12 \r\n")).content_length, 12);
  EXPECT_TRUE(vet_head(head(kPost, "Transfer-Encoding: Chunked\r\n")).chunked);
}

TEST(HttpHead, RefusesEveryAmbiguousLength) {
  for (const char* fields :
       {"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n",
        "Content-Length: 5\r\nContent-Length: 5\r\n", "Content-Length: -1\r\n",
        "Content-Length: +5\r\n", "Content-Length: 5, 5\r\n", "Content-Length: 0x5\r\n",
        "Content-Length:\r\n", "Content-Length: 99999999999999999999\r\n",
        "Transfer-Encoding: gzip, chunked\r\n", "Transfer-Encoding: identity\r\n",
        "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", "Content-Length : 5\r\n",
        " Content-Length: 5\r\n", "Content-Length: 5\nX: y\r\n", "Content-Length: 5\r\nX\r\n"})
    EXPECT_EQ(refusal(head(kPost, fields)), ErrorCode::malformed_request) << fields;
}

TEST(HttpHead, AsksForALengthWhereThereMustBeABody) {
  EXPECT_EQ(refusal(head(kPost)), ErrorCode::length_required);
  EXPECT_EQ(refusal(head("DELETE /v1/jobs/x HTTP/1.1")), std::nullopt);
}

TEST(HttpHead, AsksForOneHostWhichOldClientsNeedNotName) {
  const auto with = [](const std::string& fields) { return refusal("GET / " + fields + "\r\n"); };
  EXPECT_EQ(with("HTTP/1.1\r\n"), ErrorCode::malformed_request);
  EXPECT_EQ(with("HTTP/1.0\r\n"), std::nullopt);
  for (const char* host : {"", "x", "a-b.example:8080", "[::1]:80"})
    EXPECT_EQ(with("HTTP/1.1\r\nhost: " + std::string(host) + "\r\n"), std::nullopt) << host;
  for (const char* host : {"a b", "x/y", "u@x", "x\ty", "x\r\nHost: x"})
    EXPECT_EQ(with("HTTP/1.1\r\nHost: " + std::string(host) + "\r\n"), ErrorCode::malformed_request)
        << host;
}

TEST(HttpHead, TakesOneGzipAndNoOtherCoding) {
  const auto with = [](const std::string& codings) {
    return head(kPost, "Content-Length: 5\r\nContent-Encoding: " + codings + "\r\n");
  };
  const std::string next = "\r\nContent-Encoding: ";  // fields of one name are one list
  for (const std::string& codings :
       {std::string("gzip"), std::string("x-gzip"), std::string("GZIP"), "gzip" + next + "identity",
        "identity" + next + "gzip", std::string("gzip, identity"), std::string("identity,\tgzip"),
        std::string(", gzip ,")}) {
    EXPECT_EQ(refusal(with(codings)), std::nullopt) << codings;
    EXPECT_TRUE(vet_head(with(codings)).gzip) << codings;
  }
  for (const std::string& codings : {std::string("identity"), "identity" + next + "identity",
                                     std::string("identity, identity")}) {
    EXPECT_EQ(refusal(with(codings)), std::nullopt) << codings;
    EXPECT_FALSE(vet_head(with(codings)).gzip) << codings;
  }
  for (const std::string& codings :
       {std::string("br"), std::string("deflate"), std::string("gzip, gzip"),
        "gzip" + next + "gzip", "gzip, identity" + next + "gzip", std::string("gzip, br"),
        std::string("gzip identity"), std::string()}) {
    EXPECT_EQ(refusal(with(codings)), ErrorCode::unsupported_media_type) << codings;
    EXPECT_TRUE(vet_head(with(codings)).unknown_coding);
  }
}

TEST(HttpHead, RefusesWhatIsNoRequestLine) {
  for (const char* line :
       {"", " ", "GET", "GET /", "GET  HTTP/1.1", "GET x HTTP/1.1", "GET / HTTP/2.0",
        "GET / / HTTP/1.1", "G\x01T / HTTP/1.1", "GET /\x7f HTTP/1.1", "\x16\x03\x01"})
    EXPECT_EQ(refusal(head(line)), ErrorCode::malformed_request) << line;
}

TEST(HttpHead, TakesTheQueryFromTheParser) {
  for (const auto& [target, path, query] : {std::tuple{"/a?b=c", "/a", "b=c"},
                                            {"/a?b=?&=", "/a", "b=?&="},
                                            {"http://h?b", "/", "b"},
                                            {"/a?", "/a", ""},
                                            {"/a?b#c?d", "/a", "b"},
                                            {"/a#b?c", "/a", ""},
                                            {"/a", "/a", ""}}) {
    std::string text = head("GET " + std::string(target) + " HTTP/1.1", "X: ?y\r\n");
    const Framing framing = vet_head(text);
    const std::ptrdiff_t shorter = simplify(text, framing);
    EXPECT_EQ(framing.query, query) << target;
    EXPECT_EQ(text, head("GET " + std::string(path) + " HTTP/1.1", "X: ?y\r\n")) << target;
    EXPECT_EQ(shorter, std::ssize(std::string(target)) - std::ssize(std::string(path)));
  }
}

/// The head as it is parsed.
std::string simplified(std::string text) {
  simplify(text, vet_head(text));
  return text;
}

TEST(HttpHead, ReadsAbsoluteTargetsAsTheirPaths) {  // RFC 9112, 3.2.2
  const std::string fields = "Content-Length: 3\r\n";
  for (const auto& [target, path] : {std::pair{"http://host/a?b=c", "/a"},
                                     {"HTTPS://[::1]:8080/", "/"},
                                     {"http://host", "/"},
                                     {"http://host?b=/c", "/"},
                                     {"http://host//x", "//x"},
                                     {"/http://host/a", "/http://host/a"}})
    EXPECT_EQ(simplified(head("POST " + std::string(target) + " HTTP/1.1", fields)),
              head("POST " + std::string(path) + " HTTP/1.1", fields));
}

TEST(HttpHead, KeepsRangesFromTheParser) {
  const std::string range = "Range: items=0-5\r\n";
  const std::string body = "\r\nRange: stays\r\n";  // it is no field
  for (const char* line : {"POST / HTTP/1.1", "PUT http://x/ HTTP/1.1", "GET / HTTP/1.1"}) {
    const std::string length = "Content-Length: 3\r\n";
    const std::string plain = simplified(head(line, length) + body);
    EXPECT_EQ(simplified(head(line, "rAnGe:\r\n" + range + length + range) + body), plain);
    EXPECT_TRUE(plain.ends_with(body));
  }
}

TEST(HttpHead, HandsOutFieldsAsTheyCame) {
  const Framing framing = vet_head(head("GET / HTTP/1.1", "A:  b%20c \r\nRange: x\r\na: \xff\r\n"));
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"Host", "x"}, {"A", "b%20c"}, {"Range", "x"}, {"a", "\xff"}};
  EXPECT_EQ(framing.fields, expected);
}

TEST(HttpHead, HoldsTheHostOfATargetToTheRulesOfHosts) {
  for (const char* target :
       {"http:///a", "http://", "http://user@host/a", "http://a b/", "ftp://x/", "http:/x",
        "http://ho\x01st/", "http://ho\\st/", "host:80", "*"})
    EXPECT_EQ(refusal(head("GET " + std::string(target) + " HTTP/1.1")),
              ErrorCode::malformed_request)
        << target;
  EXPECT_EQ(refusal("GET http://host/ HTTP/1.1\r\n\r\n"), ErrorCode::malformed_request)
      << "without a Host header";
}

TEST(HttpHead, RefusesTwoValuesOfWhatHasOne) {
  const std::string type = "Content-Type: model/obj\r\n";
  const auto refused = [](const std::string& fields) {
    return refusal(head("GET / HTTP/1.1", fields));
  };
  EXPECT_EQ(refused(type + "content-type: text/csv\r\n"), ErrorCode::malformed_request);
  EXPECT_EQ(refused("Authorization: Bearer a\r\nAuthorization: Bearer b\r\n"),
            ErrorCode::malformed_request);
  EXPECT_EQ(refused(type + "X: y\r\n" + type), std::nullopt) << "twice the same";
  EXPECT_EQ(refused("Accept: a/b\r\nAccept: c/d\r\n"), std::nullopt) << "a list";
}

TEST(HttpHead, KnowsWhoWantsNoOtherAnswer) {
  const auto last = [](const std::string& version, const std::string& fields) {
    return vet_head(head("GET / HTTP/" + version, fields)).last;
  };
  EXPECT_FALSE(last("1.1", ""));
  EXPECT_FALSE(last("1.1", "Connection: keep-alive, closed\r\n"));
  EXPECT_TRUE(last("1.1", "Connection: TE ,Close\r\n"));
  EXPECT_TRUE(last("1.0", ""));
  EXPECT_FALSE(last("1.0", "Connection: Keep-Alive\r\n"));
}

TEST(HttpHead, TrailersAreFieldsThatDelimitNothing) {
  for (const char* line : {"X: y", "x:", "Digest: a:b\t"}) EXPECT_TRUE(is_trailer(line)) << line;
  for (const char* line : {"", "X", ": y", "X : y", " X: y", "GET / x: 1", "X: a\nY: b", "X: a\rb",
                           "content-length: 5", "Transfer-Encoding: chunked", "Host: x"})
    EXPECT_FALSE(is_trailer(line)) << line;
}

TEST(HttpHead, KnowsWhoWaitsFor100) {
  EXPECT_TRUE(
      vet_head(head(kPost, "Content-Length: 5\r\nExpect: 100-Continue\r\n")).awaits_continue);
  EXPECT_FALSE(vet_head(head(kPost, "Content-Length: 5\r\n")).awaits_continue);
  EXPECT_FALSE(vet_head("POST / HTTP/1.0\r\nContent-Length: 5\r\nExpect: 100-continue\r\n\r\n")
                   .awaits_continue);
}

TEST(HttpHead, KeepsItsLimits) {
  EXPECT_EQ(refusal(head("GET /" + std::string(9000, 'a') + " HTTP/1.1")),
            ErrorCode::headers_too_large);
  EXPECT_EQ(refusal(head("GET / HTTP/1.1", "X: " + std::string(9000, 'a') + "\r\n")),
            ErrorCode::headers_too_large);
  std::string fields;
  for (int i = 0; i < 101; ++i) fields += "X-" + std::to_string(i) + ": y\r\n";
  EXPECT_EQ(refusal(head("GET / HTTP/1.1", fields)), ErrorCode::headers_too_large);
}

TEST(HttpHead, AnyBytesAreAnsweredWithAnErrorOrAFraming) {
  std::mt19937 random(7);
  const std::string good = head(kPost, "Content-Length: 5\r\nAccept: */*\r\n");
  for (int k = 0; k < 20'000; ++k) {
    std::string text = good;
    for (int changes = 0; changes < 3; ++changes)
      text[random() % (text.size() - 4)] = static_cast<char>(random());
    refusal(text);  // must return
  }
}

}  // namespace
}  // namespace unwrapd::server::http
