#include "server/access/rate_limit.hpp"

#include <algorithm>
#include <cmath>

namespace unwrapd::server::access {
namespace {

constexpr double kSecondsPerMinute = 60;
constexpr std::int64_t kUsPerSecond = 1'000'000;
constexpr std::int64_t kUsPerMinute = 60 * kUsPerSecond;

}  // namespace

int RateLimit::wait_seconds(const std::string& key, std::int64_t per_minute, Clock::time_point now,
                            double cost) {
  if (per_minute == 0) return 0;
  const auto most = static_cast<double>(per_minute);
  cost = std::min(cost, most);
  const std::lock_guard lock(mutex_);
  const auto [found, is_new] = buckets_.try_emplace(key, Bucket{.tokens = most, .filled = now});
  Bucket& bucket = found->second;
  const std::chrono::duration<double> since = now - bucket.filled;
  bucket.tokens = std::min(most, bucket.tokens + since.count() * most / kSecondsPerMinute);
  bucket.filled = now;
  if (bucket.tokens >= cost) {
    bucket.tokens -= cost;
    return 0;
  }
  return static_cast<int>(std::ceil((cost - bucket.tokens) * kSecondsPerMinute / most));
}

// A bucket is kept as the time at which it will be full again: a request puts that off by the time
// that its tokens need, and may go on if it is no more than a minute away. `excluded` is what a
// full bucket would get, now + ?2. A time that is two minutes away is of a clock that was set back.
int wait_seconds_of_all(database::Database& database, const std::string& key,
                        std::int64_t per_minute, double cost) {
  const auto take_us = static_cast<std::int64_t>(
      std::ceil(cost * static_cast<double>(kUsPerMinute) / static_cast<double>(per_minute)));
  const std::string next =
      "GREATEST(CASE WHEN rates.full_us > excluded.full_us - ?2 + 2 * ?3"
      " THEN 0 ELSE rates.full_us + ?2 END, excluded.full_us)";
  return database.change([&] {
    // Of no worth after a crash: nobody waits for the disk, or for a standby.
    database::Statement(database, "SELECT set_config('synchronous_commit', 'off', true)").run();
    database::Statement(database,
                        "INSERT INTO rates (key, full_us)"
                        " SELECT ?1, (EXTRACT(EPOCH FROM clock_timestamp()) * 1000000)::bigint + ?2"
                        " ON CONFLICT (key) DO UPDATE SET full_us = " +
                            next + " WHERE " + next + " <= excluded.full_us - ?2 + ?3")
        .with(key, take_us, kUsPerMinute)
        .run();
    if (database.changes() == 1) return 0;
    database::Statement full(
        database,
        "SELECT full_us - (EXTRACT(EPOCH FROM clock_timestamp()) * 1000000)::bigint FROM rates"
        " WHERE key = ?1");
    const std::int64_t until_full = full.with(key).step() ? full.number(0) : 0;
    const std::int64_t wait_us = until_full + take_us - kUsPerMinute;
    return static_cast<int>(std::max<std::int64_t>(1, (wait_us + kUsPerSecond - 1) / kUsPerSecond));
  });
}

}  // namespace unwrapd::server::access
