#include "server/database/sqlite_database.hpp"

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <cerrno>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"
#include "server/database/schema_steps.hpp"

namespace unwrapd::server::database {
namespace {

constexpr int kBusyTimeoutMs = 10'000;
constexpr Dialect kDialect{.least = "MIN", .greatest = "MAX", .has_index_hints = true};

/// Whether the disk is full: SQLite knows only ENOSPC.
bool is_full(const SQLite::Database* sqlite, int code) {
  if (code != SQLITE_IOERR || sqlite == nullptr) return code == SQLITE_FULL;
  const int reason = sqlite3_system_errno(sqlite->getHandle());
  return reason == EFBIG || reason == EDQUOT;
}

bool is_damage(int code) { return code == SQLITE_NOTADB || code == SQLITE_CORRUPT; }

/// The advice for the operator.
std::string_view advice(int code) {
  if (is_damage(code)) return "restore a complete copy of it";
  if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY || code == SQLITE_PERM)
    return "the server's user must be able to write it and its folder";
  return "try again later";
}

[[noreturn]] void fail_with(int code, const std::string& file, const std::string& reason) {
  const std::string_view told = is_damage(code)
                                    ? "The server's store is damaged; the operator must repair it."
                                    : "The server's store failed; try again later.";
  throw InsideError(
      ErrorCode::storage_failed, std::string(told),
      "The server's file " + file + " failed (" + reason + "); " + std::string(advice(code)) + ".");
}

}  // namespace

template <class Call>
auto SqliteDatabase::call(const Call& make) const {
  try {
    return make(*sqlite_);
  } catch (const SQLite::Exception& e) {
    fail(e);
  }
}

namespace {

class SqliteCursor final : public Cursor {
 public:
  SqliteCursor(const SqliteDatabase& database, std::string_view sql)
      : database_(database), statement_(database.call([&](SQLite::Database& sqlite) {
          return SQLite::Statement(sqlite, std::string(sql));
        })) {}

  void bind(int position, std::string_view text) override {
    database_.call([&](auto&) { statement_.bind(position, std::string(text)); });
  }

  void bind(int position, std::int64_t number) override {
    database_.call([&](auto&) { statement_.bind(position, number); });
  }

  bool step() override {
    return database_.call([&](auto&) { return statement_.executeStep(); });
  }

  [[nodiscard]] std::int64_t number(int column) const override {
    return database_.call([&](auto&) { return statement_.getColumn(column).getInt64(); });
  }

  [[nodiscard]] std::string text(int column) const override {
    return database_.call([&](auto&) { return statement_.getColumn(column).getString(); });
  }

 private:
  const SqliteDatabase& database_;
  mutable SQLite::Statement statement_;  // its columns are not const
};

}  // namespace

SqliteDatabase::SqliteDatabase(const std::filesystem::path& path, Access access)
    : name_(path.filename()) {
  const bool writes = access == Access::write;
  const int flags = writes ? SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE : SQLite::OPEN_READONLY;
  try {
    sqlite_ = std::make_unique<SQLite::Database>(path.string(), flags | SQLite::OPEN_NOMUTEX,
                                                 kBusyTimeoutMs);
  } catch (const SQLite::Exception& e) {
    fail(e);
  }
  if (writes)
    run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
}

SqliteDatabase::~SqliteDatabase() = default;

void SqliteDatabase::fail(const SQLite::Exception& e) const {
  const int code = e.getErrorCode() & 0xff;  // some calls throw extended codes
  if (is_damage(code)) damaged_ = true;
  if (is_full(sqlite_.get(), code)) throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  fail_with(code, name_, e.what());
}

void SqliteDatabase::check(bool indices) const {
  Statement check(*this, indices ? "PRAGMA integrity_check(1)" : "PRAGMA quick_check(1)");
  const std::string found = check.step() ? check.text(0) : "no answer";
  if (found == "ok") return;
  damaged_ = true;
  fail_with(SQLITE_CORRUPT, name_, found);
}

void SqliteDatabase::copy_to(const std::filesystem::path& to) const {
  SqliteDatabase copy(to);
  copy.call([&](SQLite::Database& sqlite) {
    SQLite::Backup backup(sqlite, *sqlite_);
    const int result = backup.executeStep();  // all in one read transaction
    if (result != SQLITE_DONE) throw SQLite::Exception(sqlite3_errstr(result), result);
  });
  copy.run("PRAGMA journal_mode = DELETE");
}

void SqliteDatabase::run(const std::string& sql) {
  call([&](SQLite::Database& sqlite) { sqlite.exec(sql); });
}

int SqliteDatabase::changes() const { return sqlite_->getChanges(); }

std::unique_ptr<Cursor> SqliteDatabase::prepare(std::string_view sql) const {
  return std::make_unique<SqliteCursor>(*this, sql);
}

const Dialect& SqliteDatabase::dialect() const { return kDialect; }

std::int64_t SqliteDatabase::version() const { return number_of(*this, "PRAGMA user_version"); }

std::string SqliteDatabase::step_to(std::int64_t version) const { return sqlite_step(version); }

void SqliteDatabase::set_version(std::int64_t version) {
  run("PRAGMA user_version = " + std::to_string(version));
}

/// One statement is a transaction by itself.
void SqliteDatabase::apply_all(Extent extent, const std::function<void()>& make) {
  if (extent == Extent::one) return make();
  call([&](SQLite::Database& sqlite) {
    SQLite::Transaction all(sqlite, SQLite::TransactionBehavior::IMMEDIATE);
    make();
    all.commit();
  });
}

}  // namespace unwrapd::server::database
