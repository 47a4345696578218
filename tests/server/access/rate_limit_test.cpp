#include "server/access/rate_limit.hpp"

#include <gtest/gtest.h>

#include "server/access/key_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::access {
namespace {

TEST(RateLimit, LetsAMinutesWorthThroughAndThenOneByOne) {
  RateLimit rates;
  const RateLimit::Clock::time_point start{};
  for (int k = 0; k < 30; ++k) EXPECT_EQ(rates.wait_seconds("a", 30, start), 0);
  EXPECT_EQ(rates.wait_seconds("a", 30, start), 2);
  EXPECT_EQ(rates.wait_seconds("b", 30, start), 0);
  EXPECT_EQ(rates.wait_seconds("a", 30, start + std::chrono::seconds(2)), 0);
  EXPECT_EQ(rates.wait_seconds("a", 30, start + std::chrono::seconds(2)), 2);
  EXPECT_EQ(rates.wait_seconds("a", 0, start), 0);
}

/// With SQLite and with PostgreSQL.
class KeyRates : public testing::Test {
 protected:
  ApiKey key(std::int64_t per_minute) {
    ApiKey key;
    key.scopes.read = true;
    key.requests_per_minute = per_minute;
    return *keys_.find(keys_.add(key));
  }

  TempDir dir_;
  KeyStore keys_{dir_.path(), {}, postgres_of(dir_.path())};
};

/// Six a minute: one each ten seconds, which no test lasts.
TEST_F(KeyRates, AllowAMinutesWorthAtOnce) {
  const ApiKey limited = key(6), other = key(6), free = key(0);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(keys_.wait_seconds(limited, 1), 0);
  const int wait = keys_.wait_seconds(limited, 1);
  EXPECT_GT(wait, 0);
  EXPECT_LE(wait, 10);
  for (int k = 0; k < 7; ++k) EXPECT_EQ(keys_.wait_seconds(free, 1), 0);
  EXPECT_EQ(keys_.wait_seconds(other, 1), 0);
}

TEST_F(KeyRates, AClockThatWasSetBackLocksNobodyOut) {
  const database::PostgresAddress address = postgres_of(dir_.path());
  if (address.url.empty()) return;  // a file's limits go by another clock
  const ApiKey limited = key(6);
  EXPECT_EQ(keys_.wait_seconds(limited, 6), 0);
  const auto database = database::DatabaseAddress(address).open();
  database->change([&] { database->run("UPDATE rates SET full_us = full_us + 3600000000"); });
  EXPECT_EQ(keys_.wait_seconds(limited, 1), 0);
}

TEST_F(KeyRates, CountWhatCostsMore) {
  const ApiKey limited = key(6);
  EXPECT_EQ(keys_.wait_seconds(limited, 5), 0);
  const int wait = keys_.wait_seconds(limited, 4);  // one is left
  EXPECT_GT(wait, 20);
  EXPECT_LE(wait, 30);
  EXPECT_GT(keys_.wait_seconds(limited, 1000), 40) << "no more than a minute's worth";
  EXPECT_EQ(keys_.wait_seconds(limited, 1), 0) << "what was refused has cost nothing";
}

}  // namespace
}  // namespace unwrapd::server::access
