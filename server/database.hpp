#pragma once
// SQLite with values that clean up after themselves: a connection, a statement, a transaction.
// Every failure is Error{storage_failed}, or Error{storage_full} when there is no room to write.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace unwrapd::server {

/// One connection, in WAL mode with synchronous FULL: a commit survives a loss of power.
/// Not for use by two threads at once.
class Database {
 public:
  explicit Database(const std::filesystem::path& path);

  /// Runs statements that return nothing.
  void run(const char* sql);
  /// Rows that the last INSERT, UPDATE or DELETE touched.
  [[nodiscard]] int changes() const;
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::unique_ptr<sqlite3, Close> handle_;
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

/// A prepared statement. Values are bound by position from 1; columns are read from 0.
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
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace unwrapd::server
