#include "server/store/database.hpp"

#include <sqlite3.h>

#include <cerrno>

#include "core/base/error.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::store {
namespace {

constexpr int kBusyTimeoutMs = 10'000;

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

}  // namespace

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

Database::Database(const std::filesystem::path& path, Access access) : name_(path.filename()) {
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

void Database::fail() const {
  sqlite3* const handle = handle_.get();
  const int code = handle != nullptr ? sqlite3_errcode(handle) : SQLITE_NOMEM;
  if (is_damage(code)) damaged_ = true;
  if (handle != nullptr && is_full(handle, code))
    throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  fail_with(code, name_, handle != nullptr ? sqlite3_errmsg(handle) : "out of memory");
}

void Database::check(bool indices) const {
  Statement check(*this, indices ? "PRAGMA integrity_check(1)" : "PRAGMA quick_check(1)");
  const std::string found = check.step() ? check.text(0) : "no answer";
  if (found == "ok") return;
  damaged_ = true;
  fail_with(SQLITE_CORRUPT, name_, found);
}

void Database::copy_to(const std::filesystem::path& to) const {
  Database copy(to);
  sqlite3_backup* backup = sqlite3_backup_init(copy.handle(), "main", handle(), "main");
  if (backup == nullptr) copy.fail();
  const int stepped = sqlite3_backup_step(backup, -1);  // all in one read transaction
  const int finished = sqlite3_backup_finish(backup);
  if (stepped != SQLITE_DONE || finished != SQLITE_OK) copy.fail();
  copy.run("PRAGMA journal_mode = DELETE");
}

void Database::run(const char* sql) {
  if (sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

int Database::changes() const { return sqlite3_changes(handle()); }

Transaction::~Transaction() {
  if (!committed_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  database_.run("COMMIT");
  committed_ = true;
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(const Database& database, std::string_view sql) : database_(&database) {
  sqlite3_stmt* statement = nullptr;
  const int size = static_cast<int>(sql.size());
  if (sqlite3_prepare_v2(database.handle(), sql.data(), size, &statement, nullptr) != SQLITE_OK)
    database.fail();
  statement_.reset(statement);
}

void Statement::bind(int position, std::string_view text) {
  const auto size = static_cast<sqlite3_uint64>(text.size());
  const char* bytes = text.empty() ? "" : text.data();
  if (sqlite3_bind_text64(statement_.get(), position, bytes, size, SQLITE_TRANSIENT, SQLITE_UTF8) !=
      SQLITE_OK)
    database_->fail();
}

void Statement::bind(int position, std::int64_t number) {
  if (sqlite3_bind_int64(statement_.get(), position, number) != SQLITE_OK) database_->fail();
}

bool Statement::step() {
  const int result = sqlite3_step(statement_.get());
  if (result != SQLITE_ROW && result != SQLITE_DONE) database_->fail();
  return result == SQLITE_ROW;
}

void Statement::run() {
  while (step()) {
  }
}

std::int64_t Statement::number(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const unsigned char* bytes = sqlite3_column_text(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  if (bytes == nullptr) return {};
  return {bytes, bytes + size};
}

}  // namespace unwrapd::server::store
