#pragma once
// Which database: a file of SQLite.

#include <filesystem>
#include <memory>
#include <utility>

#include "server/store/database.hpp"

namespace unwrapd::server::store {

class DatabaseAddress {
 public:
  /// A file, which is made when it is missing.
  DatabaseAddress(std::filesystem::path file)  // NOLINT(google-explicit-constructor)
      : file_(std::move(file)) {}

  /// A connection of its own.
  [[nodiscard]] std::unique_ptr<Database> open() const;

 private:
  std::filesystem::path file_;
};

}  // namespace unwrapd::server::store
