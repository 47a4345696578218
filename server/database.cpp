#include "server/database.hpp"

#include <sqlite3.h>

#include <cerrno>

#include "core/error.hpp"
#include "server/files.hpp"

namespace unwrapd::server {
namespace {

constexpr int kBusyTimeoutMs = 10'000;

/// Whether there is no room: SQLite knows ENOSPC alone.
bool is_full(sqlite3* handle, int code) {
  if (code != SQLITE_IOERR) return code == SQLITE_FULL;
  const int reason = sqlite3_system_errno(handle);
  return reason == EFBIG || reason == EDQUOT;
}

/// What passes by itself, and what somebody must see to. Users read it: the folder stays out of it.
std::string_view advice(int code) {
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) return "put a whole copy of it back";
  if (code == SQLITE_CANTOPEN || code == SQLITE_READONLY || code == SQLITE_PERM)
    return "the server's user must be able to write it and its folder";
  return "try again later";
}

[[noreturn]] void fail(sqlite3* handle, const std::string& file) {
  const std::string reason = handle != nullptr ? sqlite3_errmsg(handle) : "out of memory";
  const int code = handle != nullptr ? sqlite3_errcode(handle) : SQLITE_NOMEM;
  if (is_full(handle, code)) throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  throw Error(ErrorCode::storage_failed, "The server's file " + file + " failed (" + reason +
                                             "); " + std::string(advice(code)) + ".");
}

[[noreturn]] void fail(sqlite3* handle) {
  const char* path = sqlite3_db_filename(handle, nullptr);
  fail(handle, path == nullptr ? "" : std::filesystem::path(path).filename().string());
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

Database::Database(const std::filesystem::path& path) {
  sqlite3* handle = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  const int result = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
  handle_.reset(handle);
  if (result != SQLITE_OK) fail(handle, path.filename().string());
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
}

void Database::run(const char* sql) {
  if (sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail(handle());
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

Statement::Statement(const Database& database, std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int size = static_cast<int>(sql.size());
  if (sqlite3_prepare_v2(database.handle(), sql.data(), size, &statement, nullptr) != SQLITE_OK)
    fail(database.handle());
  statement_.reset(statement);
}

void Statement::bind(int position, std::string_view text) {
  const auto size = static_cast<sqlite3_uint64>(text.size());
  const char* bytes = text.empty() ? "" : text.data();
  if (sqlite3_bind_text64(statement_.get(), position, bytes, size, SQLITE_TRANSIENT, SQLITE_UTF8) !=
      SQLITE_OK)
    fail(sqlite3_db_handle(statement_.get()));
}

void Statement::bind(int position, std::int64_t number) {
  if (sqlite3_bind_int64(statement_.get(), position, number) != SQLITE_OK)
    fail(sqlite3_db_handle(statement_.get()));
}

bool Statement::step() {
  const int result = sqlite3_step(statement_.get());
  if (result != SQLITE_ROW && result != SQLITE_DONE) fail(sqlite3_db_handle(statement_.get()));
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

}  // namespace unwrapd::server
