#pragma once
// How often a key may be used.

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "server/database/database.hpp"

namespace unwrapd::server::access {

/// At most so many requests a minute, a minute's worth of them at once (token bucket).
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// 0 when the request may go on, else the whole seconds after which it may.
  /// cost: for how many requests it counts, which are a minute's worth at most.
  int wait_seconds(const std::string& key, std::int64_t per_minute, Clock::time_point now,
                   double cost = 1);

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled{};
  };
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

/// The same for all nodes of a database with a URL, exactly, by the clock of that database. cost:
/// at most per_minute.
int wait_seconds_of_all(database::Database& database, const std::string& key,
                        std::int64_t per_minute, double cost);

}  // namespace unwrapd::server::access
