#pragma once
// Removes what is kept long enough: first the files of a finished job (410 from then on), and after
// as long again the job itself (404).

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "server/blob_store.hpp"
#include "server/job_store.hpp"
#include "server/log.hpp"

namespace unwrapd::server {

/// One sweep at this time.
void sweep(JobStore& store, BlobStore& blobs, std::int64_t now_ms, std::chrono::seconds keep);

/// Sweeps again and again until it is destroyed.
class Sweeper {
 public:
  Sweeper(JobStore& store, BlobStore& blobs, const Log& log, std::chrono::seconds keep);

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace unwrapd::server
