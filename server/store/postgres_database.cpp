#include "server/store/postgres_database.hpp"

#include <charconv>
#include <thread>
#include <utility>
#include <vector>

#include "api/json.hpp"
#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/base/utf8.hpp"
#include "server/store/schema_steps.hpp"

namespace unwrapd::server::store {
namespace {

using namespace std::chrono_literals;

constexpr Dialect kPostgresDialect{.least = "LEAST", .greatest = "GREATEST"};
constexpr auto kPauseBetweenTries = 50ms;  // of one call
constexpr auto kPauseWhileAway = 500ms;    // of all calls
constexpr std::size_t kWriterBytes = 16;
constexpr const char* kOwnTables =
    "SELECT pg_advisory_xact_lock(1431193452, hashtext(current_schema()) # 1);"
    "CREATE TABLE IF NOT EXISTS schema_version (version BIGINT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS writers (id TEXT PRIMARY KEY, number BIGINT NOT NULL,"
    " at TIMESTAMPTZ NOT NULL DEFAULT now())";
constexpr const char* kForgetWriters = "DELETE FROM writers WHERE at < now() - interval '1 day'";
constexpr const char* kLock = "SELECT pg_try_advisory_lock(1431193452, hashtext(current_schema()))";

/// PostgreSQL has neither NUL nor what is not UTF-8.
std::string as_text(std::string_view bytes) {
  std::string text(bytes);
  if (is_utf8_text(text) && text.find('\0') == std::string::npos) return text;
  for (char& c : text)
    if (c == '\0') c = '\xff';
  const api::Json json(std::move(text));
  return api::Json::parse(json.dump(-1, ' ', false, api::Json::error_handler_t::replace));
}

/// All rows are there after the first step.
class PostgresCursor final : public Cursor {
 public:
  PostgresCursor(const PostgresDatabase& database, std::string_view sql)
      : database_(database), sql_(sql) {}

  void bind(int position, std::string_view text) override {
    value_at(position) = {.text = as_text(text), .type = kTextType};
  }
  void bind(int position, std::int64_t number) override {
    value_at(position) = {.text = std::to_string(number), .type = kNumberType};
  }

  bool step() override {
    if (!rows_) rows_ = database_.execute(sql_, values_);
    return ++row_ < rows_->rows();
  }

  [[nodiscard]] std::int64_t number(int column) const override {
    const std::string text = rows_->text(row_, column);
    std::int64_t number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
  }

  [[nodiscard]] std::string text(int column) const override { return rows_->text(row_, column); }

 private:
  BoundValue& value_at(int position) {
    const auto count = static_cast<std::size_t>(position);
    if (values_.size() < count) values_.resize(count, {.text = "", .type = kTextType});
    return values_[count - 1];
  }

  const PostgresDatabase& database_;
  const std::string sql_;
  std::vector<BoundValue> values_;
  std::optional<PostgresResult> rows_;
  int row_ = -1;
};

}  // namespace

PostgresDatabase::PostgresDatabase(PostgresAddress address)
    : address_(std::move(address)), writer_(random_hex(kWriterBytes)) {
  try {
    link_until(Clock::now() + address_.patience, false);
    make_tables();
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
}

void PostgresDatabase::try_link() const {
  link_.reset();
  auto link = std::make_unique<PostgresLink>(address_.url);
  if (claimed_ && link->run(kLock).text(0, 0) != "t")
    throw LinkLost{"another unwrapd uses it; stop that one"};
  link_ = std::move(link);
}

/// Throws StoreAway when it cannot be reached until then.
void PostgresDatabase::link_until(Clock::time_point end, bool in_doubt) const {
  while (true) {
    try {
      return try_link();
    } catch (const LinkLost& lost) {
      why_away_ = lost.reason;
    }
    const Clock::time_point now = Clock::now();
    if (now >= end) {
      next_try_ = now + kPauseWhileAway;
      was_away_ = true;
      throw StoreAway(why_away_, in_doubt);
    }
    std::this_thread::sleep_for(kPauseBetweenTries);
  }
}

/// The session. While there is none, one call in a while tries to make one.
PostgresLink& PostgresDatabase::link() const {
  if (link_) return *link_;
  if (Clock::now() >= next_try_) {
    link_until(Clock::now(), false);
    return *link_;
  }
  was_away_ = true;
  throw StoreAway(why_away_, false);
}

void PostgresDatabase::patiently(const Attempt& attempt) const {
  link();
  const Clock::time_point end = Clock::now() + address_.patience;
  while (true) {
    try {
      return attempt(*link_);
    } catch (const LinkLost& lost) {
      why_away_ = lost.reason;
    }
    link_until(end, false);
  }
}

PostgresResult PostgresDatabase::execute(const std::string& sql,
                                         const std::vector<BoundValue>& values) const {
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
  const auto run_once = [&](PostgresLink& link) { changes_ = link.run(sql).changed(); };
  if (in_transaction_) {
    run_once(*link_);
  } else {
    patiently(run_once);
  }
}

std::unique_ptr<Cursor> PostgresDatabase::prepare(std::string_view sql) const {
  return std::make_unique<PostgresCursor>(*this, sql);
}

const Dialect& PostgresDatabase::dialect() const { return kPostgresDialect; }

std::int64_t PostgresDatabase::version() const {
  Statement version(*this, "SELECT COALESCE(MAX(version), 0) FROM schema_version");
  version.step();
  return version.number(0);
}

std::string PostgresDatabase::step_to(std::int64_t version) const { return postgres_step(version); }

void PostgresDatabase::set_version(std::int64_t version) {
  run("DELETE FROM schema_version; INSERT INTO schema_version VALUES (" + std::to_string(version) +
      ")");
}

void PostgresDatabase::check_reachable() const {
  patiently([](PostgresLink& link) { link.run("SELECT 1"); });
}

void PostgresDatabase::claim() {
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
  in_doubt = true;
  link_->run("COMMIT");
}

/// Where the session is lost, there is nothing to roll back.
void PostgresDatabase::roll_back() noexcept {
  try {
    link_->run("ROLLBACK");
  } catch (...) {
    link_.reset();
  }
}

void PostgresDatabase::apply_all(Extent /*extent*/, const std::function<void()>& make) {
  link();
  const std::int64_t number = ++number_;
  const Clock::time_point end = Clock::now() + address_.patience;
  for (bool in_doubt = false;;) {
    in_transaction_ = true;
    try {
      attempt(number, make, in_doubt);
      in_transaction_ = false;
      return;
    } catch (const LinkLost& lost) {
      why_away_ = lost.reason;
      in_transaction_ = false;
    } catch (...) {
      in_transaction_ = false;
      roll_back();
      throw;
    }
    link_until(end, in_doubt);
  }
}

}  // namespace unwrapd::server::store
