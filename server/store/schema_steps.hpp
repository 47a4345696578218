#pragma once
// The SQL that leads from each version of the tables to the next, for each engine.

#include <cstdint>
#include <string>

namespace unwrapd::server::store {

inline constexpr std::int64_t kSchemaVersion = 10;  ///< of this program

/// From version - 1 to this one; empty where nothing is to do.
std::string sqlite_step(std::int64_t version);
std::string postgres_step(std::int64_t version);

}  // namespace unwrapd::server::store
