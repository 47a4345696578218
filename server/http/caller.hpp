#pragma once
// On whose behalf a request is made. Without API keys everybody is the same caller, without limits.

#include <cstdint>
#include <string>

namespace unwrapd::server::http {

/// What one caller may have at a time; 0: no limit.
struct Quota {
  std::int64_t max_jobs = 0;   ///< queued or running
  std::int64_t max_bytes = 0;  ///< of the files of all jobs
};

struct Caller {
  std::string owner;     ///< id of the API key; empty without one
  bool sees_all = true;  ///< jobs of others, too
  Quota quota;
  std::string key_sha256 = {};  ///< of the API key: what is signed with it goes when the key goes
};

}  // namespace unwrapd::server::http
