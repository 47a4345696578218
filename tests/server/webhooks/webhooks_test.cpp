#include "server/webhooks/webhooks.hpp"

#include <gtest/gtest.h>

#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::webhooks {
namespace {

TEST(WebhooksDue, AreThoseWhoseTimeHasCome) {
  const TempDir dir;
  const database::DatabaseAddress address = database_in(dir.path());
  store::JobStore jobs(address);
  const Log log(LogLevel::off);
  Webhooks webhooks(address, "secret", {}, log, [&] { return jobs.now(); });
  EXPECT_EQ(webhooks.due_count(), 0);
  const auto database = address.open();
  const auto add = [&](const char* job, std::int64_t due_ms) {
    database->change([&] {
      database::Statement(*database,
                          "INSERT INTO deliveries (job, url, body, due_ms) VALUES (?, '', '', ?)")
          .with(std::string(job), due_ms)
          .run();
    });
  };
  add("j_1", 1);
  add("j_2", jobs.now().kept_ms() - 1);
  add("j_3", jobs.now().kept_ms() + 3'600'000);
  EXPECT_EQ(webhooks.due_count(), 2);
}

}  // namespace
}  // namespace unwrapd::server::webhooks
