// How nodes of one PostgreSQL database read the events of others. A file has one node.
#include "server/store/event_channel.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "server/database/database_address.hpp"
#include "server/database/schema.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

class EventChannels : public testing::Test {
 protected:
  /// Reads of whole tables by now, that sessions have told; -1: they have told nothing yet.
  static std::int64_t whole_reads(const database::Database& database) {
    return database::number_of(
        database,
        "SELECT CASE WHEN SUM(COALESCE(idx_scan, 0)) = 0 THEN -1 ELSE SUM(seq_scan)"
        " END::bigint FROM pg_stat_user_tables WHERE schemaname = current_schema()"
        " AND relname IN ('events', 'jobs')");
  }

  TempDir dir_;
  const database::PostgresAddress address_ = postgres_of(dir_.path());
};

/// A plan that was made while the tables were empty is kept.
TEST_F(EventChannels, ReadNoTableWhole) {
  if (address_.url.empty()) return;
  const auto database = database::DatabaseAddress(address_).open();
  database::migrate(*database);
  EventChannel channel(address_);
  const auto read = [&] {
    channel.after({{"j_1", 0}, {"j_2", 0}});
    channel.ended({{"j_1", 0}, {"j_2", 0}});
  };
  for (int k = 0; k < 10; ++k) read();
  std::vector<EventRow> events;
  for (int k = 1; k <= 400; ++k)
    events.push_back(
        {.job = "j_" + std::to_string(k % 40), .seq = k, .frame = "f", .progress = ""});
  channel.append(events);
  // Sessions tell once a second, later on a busy machine. Reads of whole tables would go on for
  // ever.
  std::int64_t before = -1;
  for (int tries = 0; tries < 20; ++tries) {
    for (int k = 0; k < 10; ++k) read();
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    read();
    const std::int64_t now = whole_reads(*database);
    if (now >= 0 && now == before) return;
    before = now;
  }
  ADD_FAILURE() << before << " reads of whole tables, and more with each";
}

TEST_F(EventChannels, ReadWhatFollowsOfEachJobInItsOrder) {
  if (address_.url.empty()) return;
  const auto database = database::DatabaseAddress(address_).open();
  database::migrate(*database);
  EventChannel channel(address_);
  std::vector<EventRow> events;
  for (const char* job : {"j_b", "j_a", "j_c"})
    for (int k = 1; k <= 3; ++k)
      events.push_back({.job = job, .seq = k, .is_last = k == 3, .frame = "", .progress = ""});
  channel.append(events);
  std::string read;
  for (const EventRow& event : channel.after({{"j_b", 2}, {"j_a", 0}, {"j_none", 0}}))
    read += event.job + std::to_string(event.seq) + (event.is_last ? "! " : " ");
  EXPECT_EQ(read, "j_a1 j_a2 j_a3! j_b3! ");
  EXPECT_EQ(channel.ended({{"j_gone", 0}}), std::vector<std::string>{"j_gone"});
}

}  // namespace
}  // namespace unwrapd::server::store
