#include "server/store/sqlite_database.hpp"

#include <sqlite3.h>

#include <cerrno>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"
#include "server/store/schema_steps.hpp"

namespace unwrapd::server::store {
namespace {

constexpr int kBusyTimeoutMs = 10'000;
constexpr Dialect kDialect{.least = "MIN", .greatest = "MAX", .has_index_hints = true};

/// Whether the disk is full: SQLite knows only ENOSPC.
bool is_full(sqlite3* handle, int code) {
  if (code != SQLITE_IOERR) return code == SQLITE_FULL;
  const int reason = sqlite3_system_errno(handle);
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

class SqliteCursor final : public Cursor {
 public:
  SqliteCursor(const SqliteDatabase& database, std::string_view sql) : database_(database) {
    sqlite3_stmt* statement = nullptr;
    const int size = static_cast<int>(sql.size());
    if (sqlite3_prepare_v2(database.handle(), sql.data(), size, &statement, nullptr) != SQLITE_OK)
      database.fail();
    statement_.reset(statement);
  }

  void bind(int position, std::string_view text) override {
    const auto size = static_cast<sqlite3_uint64>(text.size());
    const char* bytes = text.empty() ? "" : text.data();
    if (sqlite3_bind_text64(statement_.get(), position, bytes, size, SQLITE_TRANSIENT,
                            SQLITE_UTF8) != SQLITE_OK)
      database_.fail();
  }

  void bind(int position, std::int64_t number) override {
    if (sqlite3_bind_int64(statement_.get(), position, number) != SQLITE_OK) database_.fail();
  }

  bool step() override {
    const int result = sqlite3_step(statement_.get());
    if (result != SQLITE_ROW && result != SQLITE_DONE) database_.fail();
    return result == SQLITE_ROW;
  }

  [[nodiscard]] std::int64_t number(int column) const override {
    return sqlite3_column_int64(statement_.get(), column);
  }

  [[nodiscard]] std::string text(int column) const override {
    const unsigned char* bytes = sqlite3_column_text(statement_.get(), column);
    const int size = sqlite3_column_bytes(statement_.get(), column);
    if (bytes == nullptr) return {};
    return {bytes, bytes + size};
  }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  const SqliteDatabase& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// Rolls back unless it was committed.
class Transaction {
 public:
  explicit Transaction(SqliteDatabase& database) : database_(database) {
    database.run("BEGIN IMMEDIATE");
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction() {
    if (!committed_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
  void commit() {
    database_.run("COMMIT");
    committed_ = true;
  }

 private:
  SqliteDatabase& database_;
  bool committed_ = false;
};

}  // namespace

void SqliteDatabase::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

SqliteDatabase::SqliteDatabase(const std::filesystem::path& path, Access access)
    : name_(path.filename()) {
  sqlite3* handle = nullptr;
  const bool writes = access == Access::write;
  const int flags = writes ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  const int result = sqlite3_open_v2(path.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  handle_.reset(handle);
  if (result != SQLITE_OK) fail();
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  if (writes)
    run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
}

void SqliteDatabase::fail() const {
  sqlite3* const handle = handle_.get();
  const int code = handle != nullptr ? sqlite3_errcode(handle) : SQLITE_NOMEM;
  if (is_damage(code)) damaged_ = true;
  if (handle != nullptr && is_full(handle, code))
    throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  fail_with(code, name_, handle != nullptr ? sqlite3_errmsg(handle) : "out of memory");
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
  sqlite3_backup* backup = sqlite3_backup_init(copy.handle(), "main", handle(), "main");
  if (backup == nullptr) copy.fail();
  const int stepped = sqlite3_backup_step(backup, -1);  // all in one read transaction
  const int finished = sqlite3_backup_finish(backup);
  if (stepped != SQLITE_DONE || finished != SQLITE_OK) copy.fail();
  copy.run("PRAGMA journal_mode = DELETE");
}

void SqliteDatabase::run(const std::string& sql) {
  if (sqlite3_exec(handle(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

int SqliteDatabase::changes() const { return sqlite3_changes(handle()); }

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
  Transaction all(*this);
  make();
  all.commit();
}

}  // namespace unwrapd::server::store
