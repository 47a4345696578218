#pragma once
// SQLite, called through SQLiteCpp: the engine of a store that is a file.

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include "server/database/database.hpp"

namespace SQLite {
class Database;
class Exception;
}  // namespace SQLite

namespace unwrapd::server::database {

/// In WAL mode with synchronous FULL.
class SqliteDatabase final : public Database {
 public:
  enum class Access { write, read };

  /// To write: made when it is missing.
  explicit SqliteDatabase(const std::filesystem::path& path, Access access = Access::write);
  ~SqliteDatabase() override;

  void run(const std::string& sql) override;
  [[nodiscard]] std::unique_ptr<Cursor> prepare(std::string_view sql) const override;
  [[nodiscard]] int changes() const override;
  [[nodiscard]] const Dialect& dialect() const override;
  [[nodiscard]] std::int64_t version() const override;
  [[nodiscard]] std::string step_to(std::int64_t version) const override;
  void set_version(std::int64_t version) override;
  /// Reads the whole file.
  void check(bool indices = false) const override;
  [[nodiscard]] bool is_damaged() const override { return damaged_; }

  /// Makes a file of the state of one moment, while others write (SQLite's backup API). It has no
  /// -wal file beside it, and is on the disk on return.
  void copy_to(const std::filesystem::path& to) const;
  /// What make() returns, with SQLiteCpp's exceptions as ours.
  template <class Call>
  auto call(const Call& make) const;

 private:
  [[noreturn]] void fail(const SQLite::Exception& e) const;
  void apply_all(Extent extent, const std::function<void()>& make) override;

  std::string name_;  // of the file
  std::unique_ptr<SQLite::Database> sqlite_;
  mutable std::atomic<bool> damaged_ = false;
};

}  // namespace unwrapd::server::database
