// What needs libpq, but no PostgreSQL server.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <string>

#include "server/database/database_address.hpp"
#include "server/database/numbered_places.hpp"
#include "server/database/postgres_link.hpp"
#include "tests/server/reason_for.hpp"

namespace unwrapd::server::database {
namespace {

TEST(PostgresTexts, HaveTheirPlacesInDollars) {
  EXPECT_EQ(with_dollars("a = ? AND b = ? AND c = '?'"), "a = $1 AND b = $2 AND c = '?'");
  EXPECT_EQ(with_dollars("a = ?2 OR b = ?1 OR c = ?10"), "a = $2 OR b = $1 OR c = $10");
}

std::string reason_for_url(const std::string& url) {
  return reason_for([&] {
    static_cast<void>(
        DatabaseAddress(PostgresAddress{.url = url, .patience = std::chrono::milliseconds(1)})
            .open());
  });
}

TEST(PostgresNumbers, AreReadToTheirEnds) {
  EXPECT_EQ(number_in("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(number_in(""), 0);
  for (const char* text : {"1.5", "t", "9223372036854775808", " 1"})
    EXPECT_THROW(number_in(text), InsideError) << text;
}

TEST(PostgresUrl, IsNotQuotedWhereAPieceOfItMayBeAPassword) {
  for (const char* secret : {"hush%zz", "hush/b", "1/hush", "hush@b", "hush#b@c/d"}) {
    const std::string reason =
        reason_for_url(std::string("postgres://user:") + secret + "@127.0.0.1:1/none");
    EXPECT_EQ(reason.find("hush"), std::string::npos) << reason;
    EXPECT_NE(reason.find("%2F"), std::string::npos) << reason;
  }
  for (const char* url : {"postgres://user:hush/none", "postgres://user:hush?a@127.0.0.1:1/none",
                          "postgres://user:a?b@hush@127.0.0.1:1/none"}) {
    const std::string reason = reason_for_url(url);
    EXPECT_EQ(reason.find("hush"), std::string::npos) << reason;
  }
}

}  // namespace
}  // namespace unwrapd::server::database
