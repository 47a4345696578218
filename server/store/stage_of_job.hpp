#pragma once

#include <cstdint>
#include <string>

namespace unwrapd::server::store {

/// A stage of a job whose work several processes share.
struct StageOfJob {
  std::int64_t job = 0;  ///< its seq
  int attempt = 0;
  std::string stage;  ///< a digest of all that it works on
};

}  // namespace unwrapd::server::store
