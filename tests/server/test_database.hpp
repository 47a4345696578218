#pragma once
// The database of a test: a file in its folder or, where TEST_POSTGRESQL names a PostgreSQL
// server (tests/postgres/with_postgres.mjs), a schema of its own there.

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "server/store/data_directory.hpp"

namespace unwrapd::server {

/// Without a URL: the test is for SQLite.
inline database::PostgresAddress postgres_of(const std::filesystem::path& folder) {
  const char* server = std::getenv("TEST_POSTGRESQL");
  if (server == nullptr) return {};
  const std::string schema = "t" + std::to_string(std::hash<std::string>()(folder.string()));
  const auto database = database::DatabaseAddress(database::PostgresAddress{.url = server}).open();
  database->transact([&] { database->run("CREATE SCHEMA IF NOT EXISTS " + schema); });
  return {.url = std::string(server) + "&options=-csearch_path%3D" + schema};
}

inline database::DatabaseAddress database_in(const std::filesystem::path& folder) {
  return store::address_in(folder, postgres_of(folder));
}

}  // namespace unwrapd::server
