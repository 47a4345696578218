#pragma once
// The SQL that leads from each version of the tables to the next, for each engine.

#include <cstdint>
#include <string>

namespace unwrapd::server::store {

inline constexpr std::int64_t kSchemaVersion = 12;  ///< of this program

// From version 10 to 11, and to 12, in the words of both engines.
inline constexpr const char* kNamesStep = R"sql(
ALTER TABLE jobs ADD COLUMN name TEXT NOT NULL DEFAULT '';
CREATE INDEX jobs_by_name ON jobs (name, seq) WHERE name <> '';
CREATE INDEX jobs_in_state_by_name ON jobs (name, state, seq) WHERE name <> '';
CREATE INDEX jobs_of_owner_by_name ON jobs (owner, name, seq) WHERE name <> '';
CREATE INDEX jobs_of_owner_in_state_by_name ON jobs (owner, name, state, seq) WHERE name <> '';
)sql";
inline constexpr const char* kTicketsStep = R"sql(
CREATE TABLE spent_tickets (id TEXT NOT NULL PRIMARY KEY, until_ms BIGINT NOT NULL);
)sql";

/// From version - 1 to this one; empty where nothing is to do.
std::string sqlite_step(std::int64_t version);
std::string postgres_step(std::int64_t version);

}  // namespace unwrapd::server::store
