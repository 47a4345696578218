// The tables as PostgreSQL has them. Those of version 10 are the first; later steps come in both
// engines' words.
#include "server/database/schema_steps.hpp"

namespace unwrapd::server::database {
namespace {

constexpr std::int64_t kFirstVersion = 10;
constexpr const char* kFirstTables = R"sql(
CREATE TABLE jobs (
  seq BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  id TEXT NOT NULL UNIQUE,
  state TEXT NOT NULL,
  created_ms BIGINT NOT NULL,
  finished_ms BIGINT NOT NULL DEFAULT 0,
  attempt BIGINT NOT NULL DEFAULT 0,
  crashes BIGINT NOT NULL DEFAULT 0,
  cancel_requested BIGINT NOT NULL DEFAULT 0,
  synchronous BIGINT NOT NULL,
  expired BIGINT NOT NULL DEFAULT 0,
  options TEXT NOT NULL,
  notes TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  bytes BIGINT NOT NULL,
  buffers TEXT NOT NULL,
  result_format TEXT NOT NULL DEFAULT '',
  problem TEXT NOT NULL DEFAULT 'null',
  last_event BIGINT NOT NULL DEFAULT 0,
  owner TEXT NOT NULL DEFAULT '',
  urgency BIGINT NOT NULL DEFAULT 3,
  request_key TEXT,
  content_key TEXT NOT NULL DEFAULT '',
  lease_ms BIGINT NOT NULL DEFAULT 0,
  kept_since_ms BIGINT NOT NULL DEFAULT 0,
  stored_bytes BIGINT NOT NULL DEFAULT 0,
  webhook TEXT NOT NULL DEFAULT '',
  trace TEXT NOT NULL DEFAULT '',
  asked TEXT NOT NULL DEFAULT '',
  process_ends BIGINT NOT NULL DEFAULT 0
);
CREATE INDEX jobs_by_state ON jobs (state, owner, urgency, seq);
CREATE INDEX jobs_by_owner ON jobs (owner, seq);
CREATE INDEX jobs_by_content ON jobs (owner, content_key) WHERE state = 'succeeded';
CREATE UNIQUE INDEX jobs_by_request ON jobs (owner, request_key) WHERE request_key IS NOT NULL;
CREATE INDEX jobs_of_owner ON jobs (owner, state, seq);
CREATE INDEX jobs_in_state ON jobs (state, seq);
CREATE INDEX jobs_by_end ON jobs (expired, kept_since_ms);
CREATE TABLE deliveries (
  seq BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  job TEXT NOT NULL,
  url TEXT NOT NULL,
  body TEXT NOT NULL,
  tries BIGINT NOT NULL DEFAULT 0,
  due_ms BIGINT NOT NULL,
  trace TEXT NOT NULL DEFAULT '',
  owner TEXT NOT NULL DEFAULT ''
);
CREATE INDEX deliveries_by_time ON deliveries (due_ms);
CREATE TABLE meshes (
  seq BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  id TEXT NOT NULL UNIQUE,
  owner TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  bytes BIGINT NOT NULL,
  media_type TEXT NOT NULL,
  created_ms BIGINT NOT NULL,
  kept_since_ms BIGINT NOT NULL,
  stored_bytes BIGINT NOT NULL,
  UNIQUE (owner, sha256)
);
CREATE INDEX meshes_by_time ON meshes (kept_since_ms);
CREATE TABLE written (
  times BIGINT NOT NULL,
  set_by_ms BIGINT NOT NULL DEFAULT 0,
  noted_ms BIGINT NOT NULL DEFAULT 0,
  noted_elapsed_ms BIGINT NOT NULL DEFAULT 0,
  boot TEXT NOT NULL DEFAULT ''
);
INSERT INTO written (times) VALUES (0);
CREATE TABLE stored (
  owner TEXT PRIMARY KEY,
  bytes BIGINT NOT NULL,
  jobs BIGINT NOT NULL DEFAULT 0
);
CREATE FUNCTION note_stored() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF TG_OP = 'INSERT' THEN
    INSERT INTO stored VALUES (NEW.owner, NEW.stored_bytes, 1)
      ON CONFLICT (owner) DO UPDATE
      SET bytes = stored.bytes + excluded.bytes, jobs = stored.jobs + 1;
  ELSIF TG_OP = 'UPDATE' THEN
    UPDATE stored SET bytes = bytes + NEW.stored_bytes - OLD.stored_bytes WHERE owner = NEW.owner;
  ELSE
    UPDATE stored SET bytes = bytes - OLD.stored_bytes, jobs = jobs - 1 WHERE owner = OLD.owner;
  END IF;
  RETURN NULL;
END $$;
CREATE TRIGGER jobs_stored AFTER INSERT OR DELETE ON jobs
  FOR EACH ROW EXECUTE FUNCTION note_stored();
CREATE TRIGGER jobs_changed AFTER UPDATE OF stored_bytes ON jobs
  FOR EACH ROW EXECUTE FUNCTION note_stored();
CREATE TABLE keys (
  seq BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  id TEXT NOT NULL UNIQUE,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  scopes TEXT NOT NULL,
  requests_per_minute BIGINT NOT NULL,
  max_jobs BIGINT NOT NULL,
  max_bytes BIGINT NOT NULL,
  created_ms BIGINT NOT NULL
);
)sql";

/// Keeps `shares`, as the triggers of SQLite do.
constexpr const char* kPostgresTurns = R"sql(
CREATE FUNCTION note_turns() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF TG_OP = 'INSERT' THEN
    INSERT INTO shares (owner, served_ms, waiting) VALUES (NEW.owner,
      COALESCE((SELECT MIN(served_ms) FROM shares WHERE waiting + running > 0), 0), 1)
      ON CONFLICT (owner) DO UPDATE SET waiting = shares.waiting + 1, served_ms =
        CASE WHEN shares.waiting + shares.running > 0 THEN shares.served_ms
             ELSE GREATEST(shares.served_ms, excluded.served_ms) END;
  ELSIF TG_OP = 'UPDATE' THEN
    UPDATE shares SET
      waiting = waiting + (NEW.state = 'queued')::int - (OLD.state = 'queued')::int,
      running = running + (NEW.state = 'running')::int - (OLD.state = 'running')::int,
      served_ms = served_ms + NEW.ran_ms - OLD.ran_ms
      WHERE owner = NEW.owner;
  ELSE
    UPDATE shares SET waiting = waiting - (OLD.state = 'queued')::int,
      running = running - (OLD.state = 'running')::int WHERE owner = OLD.owner;
  END IF;
  RETURN NULL;
END $$;
CREATE TRIGGER jobs_turns_new AFTER INSERT ON jobs
  FOR EACH ROW WHEN (NEW.state = 'queued') EXECUTE FUNCTION note_turns();
CREATE TRIGGER jobs_turns_changed AFTER UPDATE OF state ON jobs
  FOR EACH ROW WHEN (NEW.state <> OLD.state) EXECUTE FUNCTION note_turns();
CREATE TRIGGER jobs_turns_gone AFTER DELETE ON jobs
  FOR EACH ROW WHEN (OLD.state IN ('queued', 'running')) EXECUTE FUNCTION note_turns();
CREATE UNLOGGED TABLE events (
  job TEXT NOT NULL,
  seq BIGINT NOT NULL,
  last BIGINT NOT NULL,
  frame TEXT NOT NULL,
  progress TEXT NOT NULL,
  PRIMARY KEY (job, seq)
);
CREATE TABLE secrets (
  name TEXT PRIMARY KEY,
  value TEXT NOT NULL
);
)sql";

std::string unlogged(std::string step) {
  constexpr std::string_view kTable = "CREATE TABLE";
  for (std::size_t at = 0; (at = step.find(kTable, at)) != std::string::npos; at += kTable.size())
    step.replace(at, kTable.size(), "CREATE UNLOGGED TABLE");
  return step;
}

}  // namespace

std::string postgres_step(std::int64_t version) {
  if (version < kFirstVersion) return "";
  if (version == kFirstVersion) return kFirstTables;
  if (version == kFirstVersion + 1) return kNamesStep;
  if (version == kFirstVersion + 2) return kTicketsStep;
  if (version == kTurnsVersion) return std::string(kTurnsStep) + kPostgresTurns;
  if (version == kTurnsVersion + 1) return kNodesTogetherStep;
  return unlogged(kSharedWorkStep);
}

}  // namespace unwrapd::server::database
