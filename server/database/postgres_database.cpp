#include "server/database/postgres_database.hpp"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/database/postgres_cursor.hpp"
#include "server/database/schema_steps.hpp"

namespace unwrapd::server::database {
namespace {

using namespace std::chrono_literals;

constexpr Dialect kPostgresDialect{
    .least = "LEAST", .greatest = "GREATEST", .skip_locked = " FOR UPDATE SKIP LOCKED"};
constexpr auto kPauseBetweenTries = 50ms;  // of one call
constexpr auto kPauseWhileAway = 500ms;    // of all calls, at least
constexpr int kPausePerTry = 9;            // times what a try takes that nobody answers
constexpr std::size_t kWriterBytes = 16;
constexpr const char* kOwnTables =
    "SELECT pg_advisory_xact_lock(1431193452, hashtext(current_schema()) # 1);"
    "CREATE TABLE IF NOT EXISTS schema_version (version BIGINT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS writers (id TEXT PRIMARY KEY, number BIGINT NOT NULL,"
    " at TIMESTAMPTZ NOT NULL DEFAULT now())";
constexpr const char* kForgetWriters = "DELETE FROM writers WHERE at < now() - interval '1 day'";
constexpr const char* kLock = "SELECT pg_try_advisory_lock(1431193452, hashtext(current_schema()))";
constexpr const char* kSharedLock =
    "SELECT pg_try_advisory_lock_shared(1431193452, hashtext(current_schema()))";
constexpr const char* kNodeLock =
    "SELECT pg_try_advisory_lock(1431193453, hashtext(current_schema() || ?))";
constexpr const char* kOwnSession =
    "SELECT pid || ' of ' || backend_start FROM pg_stat_activity WHERE pid = pg_backend_pid()";
/// One that is committing is left to end by itself: ended while it waits for a standby, it would
/// have committed here alone.
constexpr const char* kEndSession =
    "SELECT pg_terminate_backend(pid, 1000) FROM pg_stat_activity"
    " WHERE pid || ' of ' || backend_start = ? AND pid <> pg_backend_pid()"
    " AND state LIKE 'idle%'";

}  // namespace

PostgresDatabase::PostgresDatabase(PostgresAddress address)
    : address_(std::move(address)), writer_(random_hex(kWriterBytes)) {
  try {
    link_until(Clock::now() + address_.patience, false);
  } catch (const StoreAway& away) {
    throw InsideError(ErrorCode::storage_failed, away.what(), away.reason());
  }
}

void PostgresDatabase::make_tables() {
  const auto is_there = [](PostgresLink& link) {
    return link.run("SELECT to_regclass('writers') IS NOT NULL").text(0, 0) == "t";
  };
  patiently([&](PostgresLink& link) {
    if (is_there(link)) return;
    link.run("BEGIN READ WRITE");
    link.run(kOwnTables);
    link.run("COMMIT");
  });
  has_own_tables_ = true;
}

/// Where the link was cut, the session before may not know it, and keep its locks: it is ended.
void PostgresDatabase::try_link() const {
  link_.reset();
  auto link = std::make_unique<PostgresLink>(address_.url);
  if (!session_.empty()) link->run(kEndSession, {{.text = session_, .type = kTextType}});
  if (claimed_) claim_on(*link);
  session_ = link->run(kOwnSession).text(0, 0);
  link_ = std::move(link);
}

/// Either alone, or as one of several nodes.
void PostgresDatabase::claim_on(PostgresLink& link) const {
  const bool is_shared = !address_.node.empty();
  if (link.run(is_shared ? kSharedLock : kLock).text(0, 0) != "t")
    throw LinkLost{is_shared ? "an unwrapd without --blobs uses it; stop that one"
                             : "another unwrapd uses it; stop that one"};
  if (!is_shared) return;
  if (link.run(kNodeLock, {{.text = address_.node, .type = kTextType}}).text(0, 0) != "t")
    throw LinkLost{"another unwrapd has the node id of this --data directory; give each its own"};
}

void PostgresDatabase::be_away(bool in_doubt) const {
  was_away_ = true;
  throw StoreAway(StorePart::database, why_away_, in_doubt);
}

/// Throws StoreAway when it cannot be reached until then.
void PostgresDatabase::link_until(Clock::time_point end, bool in_doubt) const {
  while (true) {
    const Clock::time_point begun = Clock::now();
    try {
      return try_link();
    } catch (const LinkLost& lost) {
      why_away_ = lost.reason;
    }
    const Clock::time_point now = Clock::now();
    if (now >= end) {
      next_try_ = now + std::max<Clock::duration>(kPauseWhileAway, kPausePerTry * (now - begun));
      be_away(in_doubt);
    }
    std::this_thread::sleep_for(kPauseBetweenTries);
  }
}

/// The session. While there is none, one call in a while tries to make one.
PostgresLink& PostgresDatabase::link() const {
  if (link_) return *link_;
  if (Clock::now() < next_try_) be_away(false);
  link_until(Clock::now(), false);
  return *link_;
}

/// end: that of the patience of a call, which begins with its first loss. Throws StoreAway then.
void PostgresDatabase::lose_link(const LinkLost& lost, Clock::time_point& end,
                                 bool in_doubt) const {
  link_.reset();
  why_away_ = lost.reason;
  const Clock::time_point now = Clock::now();
  if (now >= end) be_away(in_doubt);
  end = std::min(end, now + address_.patience);
}

void PostgresDatabase::patiently(const Attempt& attempt) const {
  link();
  for (Clock::time_point end = Clock::time_point::max();;) {
    try {
      if (!link_) link_until(end, false);
      return attempt(*link_);
    } catch (const LinkLost& lost) {
      lose_link(lost, end, false);
    }
  }
}

PostgresResult PostgresDatabase::execute(const std::string& sql,
                                         const std::vector<BoundValue>& values) const {
  const std::scoped_lock lock(mutex_);
  std::optional<PostgresResult> result;
  const auto run_once = [&](PostgresLink& link) { result = link.run(sql, values); };
  if (in_transaction_) {
    run_once(*link_);
  } else {
    patiently(run_once);
  }
  changes_ = result->changed();
  return std::move(*result);
}

void PostgresDatabase::run(const std::string& sql) {
  const std::scoped_lock lock(mutex_);
  const auto run_once = [&](PostgresLink& link) { changes_ = link.run(sql).changed(); };
  if (in_transaction_) {
    run_once(*link_);
  } else {
    patiently(run_once);
  }
}

std::unique_ptr<Cursor> PostgresDatabase::prepare(std::string_view sql) const {
  return postgres_cursor(*this, sql);
}

const Dialect& PostgresDatabase::dialect() const { return kPostgresDialect; }

std::int64_t PostgresDatabase::version() const {
  if (number_of(*this, "SELECT COUNT(to_regclass('schema_version'))") == 0) return 0;
  return number_of(*this, "SELECT COALESCE(MAX(version), 0) FROM schema_version");
}

std::string PostgresDatabase::step_to(std::int64_t version) const { return postgres_step(version); }

void PostgresDatabase::lock_version() {
  run("SELECT pg_advisory_xact_lock(1431193452, hashtext(current_schema()) # 2)");
}

void PostgresDatabase::set_version(std::int64_t version) {
  run("DELETE FROM schema_version; INSERT INTO schema_version VALUES (" + std::to_string(version) +
      ")");
}

void PostgresDatabase::check_reachable() const {
  const std::scoped_lock lock(mutex_);
  patiently([](PostgresLink& link) { link.run("SELECT 1"); });
}

void PostgresDatabase::claim() {
  const std::scoped_lock lock(mutex_);
  claimed_ = true;
  try {
    link_until(Clock::now() + address_.patience, false);
    change([&] { run(kForgetWriters); });
  } catch (const StoreAway& away) {
    throw InsideError(ErrorCode::storage_failed, away.what(), away.reason());
  }
}

/// A transaction of an earlier try that is still being committed holds the row: this one waits for
/// its end, and then finds its number there or not.
void PostgresDatabase::attempt(std::int64_t number, const std::function<void()>& make,
                               bool& in_doubt) {
  const std::string note = "BEGIN READ WRITE; INSERT INTO writers (id, number) VALUES ('" +
                           writer_ + "', " + std::to_string(number) +
                           ") ON CONFLICT (id) DO UPDATE SET number = excluded.number, at = now()"
                           " WHERE writers.number <> excluded.number";
  if (link_->run(note).changed() == 0) {
    link_->run("ROLLBACK");
    return;
  }
  in_doubt = false;
  make();
  try {
    link_->run("COMMIT");
  } catch (const LinkLost&) {
    in_doubt = true;
    throw;
  }
}

/// Where the session is lost, there is nothing to roll back.
void PostgresDatabase::roll_back() noexcept {
  if (!link_) return;
  try {
    link_->run("ROLLBACK");
  } catch (...) {
    link_.reset();
  }
}

/// Throws what was caught or, where a commit may have come about, that it is in doubt: whatever
/// kept it from being found out.
void PostgresDatabase::fail(bool in_doubt) const {
  if (!in_doubt) throw;
  try {
    throw;
  } catch (const StoreAway&) {
    throw;
  } catch (const std::exception& error) {
    why_away_ = reason_of(error);
  }
  be_away(true);
}

void PostgresDatabase::apply_all(Extent /*extent*/, const std::function<void()>& make) {
  const std::scoped_lock lock(mutex_);
  if (!has_own_tables_) make_tables();
  link();
  const std::int64_t number = ++number_;
  Clock::time_point end = Clock::time_point::max();
  for (bool in_doubt = false;;) {
    try {
      if (!link_) link_until(end, in_doubt);
      in_transaction_ = true;
      attempt(number, make, in_doubt);
      in_transaction_ = false;
      return;
    } catch (const LinkLost& lost) {
      in_transaction_ = false;
      lose_link(lost, end, in_doubt);
    } catch (...) {
      in_transaction_ = false;
      roll_back();
      fail(in_doubt);
    }
  }
}

}  // namespace unwrapd::server::database
