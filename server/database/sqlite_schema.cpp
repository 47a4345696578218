// The tables as SQLite has them.
#include <array>

#include "server/database/schema_steps.hpp"

namespace unwrapd::server::database {
namespace {

/// Step k turns version k into version k + 1. Released steps are never edited.
constexpr std::array<const char*, kSchemaVersion> kSteps = {
    R"sql(
CREATE TABLE jobs (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  state TEXT NOT NULL,
  created_ms INTEGER NOT NULL,
  finished_ms INTEGER NOT NULL DEFAULT 0,
  attempt INTEGER NOT NULL DEFAULT 0,
  crashes INTEGER NOT NULL DEFAULT 0,
  cancel_requested INTEGER NOT NULL DEFAULT 0,
  synchronous INTEGER NOT NULL,
  expired INTEGER NOT NULL DEFAULT 0,
  options TEXT NOT NULL,
  notes TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  bytes INTEGER NOT NULL,
  buffers TEXT NOT NULL,
  result_format TEXT NOT NULL DEFAULT '',
  problem TEXT NOT NULL DEFAULT 'null',
  last_event INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, seq);
)sql",
    R"sql(
ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN urgency INTEGER NOT NULL DEFAULT 3;
ALTER TABLE jobs ADD COLUMN request_key TEXT;
ALTER TABLE jobs ADD COLUMN content_key TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN lease_ms INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN kept_since_ms INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN stored_bytes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN webhook TEXT NOT NULL DEFAULT '';
UPDATE jobs SET kept_since_ms = finished_ms, stored_bytes = bytes;
DROP INDEX jobs_by_state;
CREATE INDEX jobs_by_state ON jobs (state, owner, urgency, seq);
CREATE INDEX jobs_by_owner ON jobs (owner, seq);
CREATE INDEX jobs_by_content ON jobs (owner, content_key) WHERE state = 'succeeded';
CREATE UNIQUE INDEX jobs_by_request ON jobs (owner, request_key) WHERE request_key IS NOT NULL;
CREATE TABLE deliveries (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  job TEXT NOT NULL,
  url TEXT NOT NULL,
  body TEXT NOT NULL,
  tries INTEGER NOT NULL DEFAULT 0,
  due_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX deliveries_by_time ON deliveries (due_ms);
)sql",
    R"sql(
ALTER TABLE jobs ADD COLUMN trace TEXT NOT NULL DEFAULT '';
ALTER TABLE deliveries ADD COLUMN trace TEXT NOT NULL DEFAULT '';
ALTER TABLE deliveries ADD COLUMN owner TEXT NOT NULL DEFAULT '';
UPDATE deliveries SET owner = COALESCE((SELECT owner FROM jobs WHERE id = job), '');
)sql",
    R"sql(
CREATE TABLE meshes (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  owner TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  bytes INTEGER NOT NULL,
  media_type TEXT NOT NULL,
  created_ms INTEGER NOT NULL,
  kept_since_ms INTEGER NOT NULL,
  stored_bytes INTEGER NOT NULL,
  UNIQUE (owner, sha256)
) STRICT;
CREATE INDEX meshes_by_time ON meshes (kept_since_ms);
)sql",
    R"sql(
CREATE INDEX jobs_by_bytes ON jobs (state, stored_bytes) WHERE expired = 0;
CREATE INDEX jobs_of_owner ON jobs (owner, state, stored_bytes);
)sql",
    R"sql(
DROP INDEX jobs_by_bytes;
DROP INDEX jobs_of_owner;
CREATE INDEX jobs_of_owner ON jobs (owner, state, seq);
CREATE INDEX jobs_in_state ON jobs (state, seq);
CREATE INDEX jobs_by_end ON jobs (expired, kept_since_ms);
CREATE TABLE written (times INTEGER NOT NULL) STRICT;
INSERT INTO written VALUES (0);
CREATE TABLE stored (
  owner TEXT PRIMARY KEY,
  bytes INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO stored SELECT owner, SUM(stored_bytes) FROM jobs GROUP BY owner;
CREATE TRIGGER jobs_stored AFTER INSERT ON jobs BEGIN
  INSERT INTO stored VALUES (NEW.owner, NEW.stored_bytes)
    ON CONFLICT (owner) DO UPDATE SET bytes = bytes + excluded.bytes;
END;
CREATE TRIGGER jobs_changed AFTER UPDATE OF stored_bytes ON jobs BEGIN
  UPDATE stored SET bytes = bytes + NEW.stored_bytes - OLD.stored_bytes WHERE owner = NEW.owner;
END;
CREATE TRIGGER jobs_removed AFTER DELETE ON jobs BEGIN
  UPDATE stored SET bytes = bytes - OLD.stored_bytes WHERE owner = OLD.owner;
END;
)sql",
    R"sql(
ALTER TABLE jobs ADD COLUMN asked TEXT NOT NULL DEFAULT '';
)sql",
    R"sql(
ALTER TABLE written ADD COLUMN set_by_ms INTEGER NOT NULL DEFAULT 0;
)sql",
    // Answers that were given before may be another method's map: none is given to a new question.
    R"sql(
UPDATE jobs SET content_key = '' WHERE state = 'succeeded';
)sql",
    R"sql(
ALTER TABLE jobs ADD COLUMN process_ends INTEGER NOT NULL DEFAULT 0;
ALTER TABLE written ADD COLUMN noted_ms INTEGER NOT NULL DEFAULT 0;
ALTER TABLE written ADD COLUMN noted_elapsed_ms INTEGER NOT NULL DEFAULT 0;
ALTER TABLE written ADD COLUMN boot TEXT NOT NULL DEFAULT '';
ALTER TABLE stored ADD COLUMN jobs INTEGER NOT NULL DEFAULT 0;
UPDATE stored SET jobs = (SELECT COUNT(*) FROM jobs WHERE jobs.owner = stored.owner);
DROP TRIGGER jobs_stored;
DROP TRIGGER jobs_removed;
CREATE TRIGGER jobs_stored AFTER INSERT ON jobs BEGIN
  INSERT INTO stored VALUES (NEW.owner, NEW.stored_bytes, 1)
    ON CONFLICT (owner) DO UPDATE SET bytes = bytes + excluded.bytes, jobs = jobs + 1;
END;
CREATE TRIGGER jobs_removed AFTER DELETE ON jobs BEGIN
  UPDATE stored SET bytes = bytes - OLD.stored_bytes, jobs = jobs - 1 WHERE owner = OLD.owner;
END;
)sql",
    kNamesStep, kTicketsStep, kTurnsStep, "", kSharedWorkStep};

/// Strict tables know BIGINT by one name alone.
std::string in_words_of_sqlite(std::string step) {
  constexpr std::string_view kTheirs = "BIGINT";
  for (std::size_t at = 0; (at = step.find(kTheirs, at)) != std::string::npos;)
    step.replace(at, kTheirs.size(), "INTEGER");
  return step;
}

/// Keeps `shares`. An owner that comes back after a pause starts level with the least served of the
/// others, so that service cannot be saved up.
constexpr const char* kSqliteTurns = R"sql(
CREATE TRIGGER jobs_turns_new AFTER INSERT ON jobs WHEN NEW.state = 'queued' BEGIN
  INSERT INTO shares (owner, served_ms, waiting) VALUES (NEW.owner,
    COALESCE((SELECT MIN(served_ms) FROM shares WHERE waiting + running > 0), 0), 1)
    ON CONFLICT (owner) DO UPDATE SET waiting = waiting + 1, served_ms =
      CASE WHEN waiting + running > 0 THEN served_ms ELSE MAX(served_ms, excluded.served_ms) END;
END;
CREATE TRIGGER jobs_turns_changed AFTER UPDATE OF state ON jobs WHEN NEW.state <> OLD.state BEGIN
  UPDATE shares SET
    waiting = waiting + (NEW.state = 'queued') - (OLD.state = 'queued'),
    running = running + (NEW.state = 'running') - (OLD.state = 'running'),
    served_ms = served_ms + NEW.ran_ms - OLD.ran_ms
    WHERE owner = NEW.owner;
END;
CREATE TRIGGER jobs_turns_gone AFTER DELETE ON jobs WHEN OLD.state IN ('queued', 'running') BEGIN
  UPDATE shares SET waiting = waiting - (OLD.state = 'queued'),
    running = running - (OLD.state = 'running') WHERE owner = OLD.owner;
END;
)sql";

}  // namespace

std::string sqlite_step(std::int64_t version) {
  const std::string step = kSteps.at(static_cast<std::size_t>(version - 1));
  if (version < kTurnsVersion) return step;
  return in_words_of_sqlite(step) + (version == kTurnsVersion ? kSqliteTurns : "");
}

}  // namespace unwrapd::server::database
