#pragma once
// Which database: a file of SQLite, or one of PostgreSQL.

#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "server/database/database.hpp"
#include "server/database/postgres_address.hpp"

namespace unwrapd::server::database {

class DatabaseAddress {
 public:
  using Open = std::function<std::shared_ptr<Database>()>;

  /// A file, which is made when it is missing.
  DatabaseAddress(std::filesystem::path file);  // NOLINT(google-explicit-constructor)
  DatabaseAddress(PostgresAddress postgres);    // NOLINT(google-explicit-constructor)
  explicit DatabaseAddress(Open open) : open_(std::move(open)) {}

  /// The same connection for all that open it; of PostgreSQL alone. Throws as Database does.
  [[nodiscard]] DatabaseAddress shared() const {
    return DatabaseAddress([database = open()] { return database; });
  }

  /// A connection of its own, unless this is shared. Throws as Database does.
  [[nodiscard]] std::shared_ptr<Database> open() const { return open_(); }

 private:
  Open open_;
};

}  // namespace unwrapd::server::database
