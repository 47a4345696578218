#pragma once
// SQLite with values that clean up after themselves: a connection, a statement, a transaction.
// Every failure is InsideError{storage_failed}, whose message tells clients nothing of SQLite, or
// Error{storage_full} when there is no room to write.

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace unwrapd::server::store {

/// One connection, in WAL mode with synchronous FULL: a commit survives a loss of power.
/// Not for use by two threads at once.
class Database {
 public:
  enum class Access { write, read };

  /// To write: made when it is missing.
  explicit Database(const std::filesystem::path& path, Access access = Access::write);

  /// Reads the whole file. Throws when it is damaged. indices: whether they say the same as the
  /// tables, too, which takes longer.
  void check(bool indices = false) const;
  /// Makes a file of the state of one moment, while others write (SQLite's backup API). It has no
  /// -wal file beside it, and is on the disk on return.
  void copy_to(const std::filesystem::path& to) const;
  /// Runs statements that return nothing.
  void run(const char* sql);
  /// Rows that the last INSERT, UPDATE or DELETE touched.
  [[nodiscard]] int changes() const;
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }
  /// Whether a page of the file was found damaged since it was opened. Thread-safe.
  [[nodiscard]] bool is_damaged() const { return damaged_; }
  /// Throws what the last failure of this connection was.
  [[noreturn]] void fail() const;

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::string name_;  // of the file
  std::unique_ptr<sqlite3, Close> handle_;
  mutable std::atomic<bool> damaged_ = false;
};

/// Changes that are made together or, when it goes without commit(), not at all.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) {
    database.run("BEGIN IMMEDIATE");
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();
  void commit();

 private:
  Database& database_;
  bool committed_ = false;
};

/// A prepared statement, which must not outlive its database. Values are bound by position from 1;
/// columns are read from 0.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);

  void bind(int position, std::string_view text);
  void bind(int position, std::int64_t number);

  /// Binds all values in order, from position 1.
  template <class... Values>
  Statement& with(const Values&... values) {
    int position = 0;
    (bind(++position, values), ...);
    return *this;
  }

  /// True when there is a row to read, false at the end.
  bool step();
  /// Runs to the end, ignoring rows.
  void run();

  [[nodiscard]] std::int64_t number(int column) const;
  [[nodiscard]] std::string text(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace unwrapd::server::store
