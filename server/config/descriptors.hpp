#pragma once
// How the files that a process may have open are shared out. Connections get what is left when
// enough is kept back for stores, the files of requests and jobs, workers and the admin port: idle
// clients then take no descriptor that an answer needs.

#include <cstdint>

#include "server/config/config.hpp"

namespace unwrapd::server::config {

inline constexpr std::int64_t kFewestDescriptors = 64;

/// The most connections to the main port where so many files may be open. Throws Error{internal}
/// where those are too few to work with.
int connections_within(std::int64_t files, const Config& config);

}  // namespace unwrapd::server::config
