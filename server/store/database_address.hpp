#pragma once
// Which database: a file of SQLite, or one of PostgreSQL.

#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "server/store/database.hpp"
#include "server/store/postgres_address.hpp"

namespace unwrapd::server::store {

class DatabaseAddress {
 public:
  using Open = std::function<std::unique_ptr<Database>()>;

  /// A file, which is made when it is missing.
  DatabaseAddress(std::filesystem::path file);  // NOLINT(google-explicit-constructor)
  DatabaseAddress(PostgresAddress postgres);    // NOLINT(google-explicit-constructor)
  explicit DatabaseAddress(Open open) : open_(std::move(open)) {}

  /// A connection of its own. Throws as Database does.
  [[nodiscard]] std::unique_ptr<Database> open() const { return open_(); }

 private:
  Open open_;
};

}  // namespace unwrapd::server::store
