#pragma once
// The SQL that leads from each version of the tables to the next, for each engine.

#include <cstdint>
#include <string>

namespace unwrapd::server::database {

inline constexpr std::int64_t kSchemaVersion = 15;  ///< of this program

// From version 10 to 11, to 12, and to 13 (its triggers follow), in the words of both engines.
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
inline constexpr std::int64_t kTurnsVersion = 13;
inline constexpr const char* kTurnsStep = R"sql(
ALTER TABLE jobs ADD COLUMN node TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN beat BIGINT NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN started_ms BIGINT NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN ran_ms BIGINT NOT NULL DEFAULT 0;
CREATE TABLE shares (
  owner TEXT NOT NULL PRIMARY KEY,
  served_ms BIGINT NOT NULL DEFAULT 0,
  waiting BIGINT NOT NULL DEFAULT 0,
  running BIGINT NOT NULL DEFAULT 0
);
INSERT INTO shares (owner, waiting, running)
  SELECT owner, COUNT(*) FILTER (WHERE state = 'queued'), COUNT(*) FILTER (WHERE state = 'running')
  FROM jobs WHERE state IN ('queued', 'running') GROUP BY owner;
CREATE TABLE nodes (
  id TEXT NOT NULL PRIMARY KEY,
  workers BIGINT NOT NULL,
  seen_ms BIGINT NOT NULL
);
)sql";

/// To version 14, of nodes with one database: a process that is alone keeps this in its memory.
inline constexpr const char* kNodesTogetherStep = R"sql(
CREATE UNLOGGED TABLE rates (key TEXT NOT NULL PRIMARY KEY, full_us BIGINT NOT NULL);
CREATE UNLOGGED TABLE worked_on (
  document TEXT NOT NULL,
  node TEXT NOT NULL,
  noted TIMESTAMPTZ NOT NULL DEFAULT clock_timestamp(),
  PRIMARY KEY (document, node)
);
)sql";

/// To version 15: work of a job that several processes do together. Of PostgreSQL the tables are
/// unlogged: what they lose is made again.
inline constexpr const char* kSharedWorkStep = R"sql(
CREATE TABLE shared_stages (
  job BIGINT NOT NULL,
  stage TEXT NOT NULL,
  program TEXT NOT NULL,
  attempt BIGINT NOT NULL,
  bundles BIGINT NOT NULL,
  from_front BIGINT NOT NULL DEFAULT 0,
  from_back BIGINT NOT NULL DEFAULT 0,
  PRIMARY KEY (job, stage)
);
CREATE TABLE shared_bundles (
  job BIGINT NOT NULL,
  stage TEXT NOT NULL,
  bundle BIGINT NOT NULL,
  bytes TEXT NOT NULL,
  PRIMARY KEY (job, stage, bundle)
);
)sql";

/// From version - 1 to this one; empty where nothing is to do.
std::string sqlite_step(std::int64_t version);
std::string postgres_step(std::int64_t version);

}  // namespace unwrapd::server::database
