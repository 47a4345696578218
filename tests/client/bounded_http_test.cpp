// What becomes of heads that no server writes.
#include "client/bounded_http.hpp"

#include <gtest/gtest.h>

#include "client/printable.hpp"

namespace unwrapd::client {
namespace {

bool takes(const std::string& head, std::size_t piece = 1000) {
  AnswerHead seen;
  for (std::size_t at = 0; at < head.size(); at += piece)
    if (!seen.takes(std::string_view(head).substr(at, piece))) return false;
  return true;
}

TEST(AnswerHead, TakesUsualOnesAndAnyBody) {
  const std::string body(1'000'000, 'x');
  for (const std::size_t piece : {std::size_t{1}, std::size_t{4096}}) {
    EXPECT_TRUE(takes("HTTP/1.1 200 OK\r\nETag: \"a\"\r\n\r\n" + body, piece));
    EXPECT_TRUE(takes("HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 202 Accepted\r\n\r\n" + body, piece));
  }
}

TEST(AnswerHead, RefusesStatusLinesThatOverflowTheLibrarysStack) {
  for (const std::size_t size : {std::size_t{600}, std::size_t{30'000}}) {
    EXPECT_FALSE(takes("HTTP/1.1 200 " + std::string(size, 'x') + "\r\n\r\n"));
    EXPECT_FALSE(
        takes("HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 200 " + std::string(size, 'x') + "\r\n"));
  }
}

TEST(AnswerHead, RefusesHeadsWithoutEnd) {
  std::string many = "HTTP/1.1 200 OK\r\n", interim;
  for (int k = 0; k < 20'000; ++k) many += "X: y\r\n", interim += "HTTP/1.1 100 Continue\r\n\r\n";
  EXPECT_FALSE(takes(many));
  EXPECT_FALSE(takes(interim));
  EXPECT_FALSE(takes("HTTP/1.1 200 OK\r\nX: " + std::string(9000, 'y')));
}

TEST(Printable, LeavesTerminalsNoCommands) {
  EXPECT_EQ(printable("\x1b[31mred\x07\r\n\x7f"), "?[31mred????");
  EXPECT_EQ(printable("\xC3\xA9\xC2\x9B[m\xC2\xA9"), "\xC3\xA9??[m\xC2\xA9");
}

}  // namespace
}  // namespace unwrapd::client
