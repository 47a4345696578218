#include "server/access/shared_secret.hpp"

#include <memory>

namespace unwrapd::server::access {
namespace {

std::optional<std::string> secret_of(const database::Database& database) {
  database::Statement statement(database, "SELECT value FROM secrets WHERE name = 'links'");
  if (!statement.step()) return std::nullopt;
  return statement.text(0);
}

}  // namespace

std::string shared_secret(const database::DatabaseAddress& address, const std::string& own) {
  const std::shared_ptr<database::Database> database = address.open();
  return database->transact([&] {
    database::Statement(
        *database, "INSERT INTO secrets (name, value) VALUES ('links', ?) ON CONFLICT DO NOTHING")
        .with(own)
        .run();
    return secret_of(*database).value();
  });
}

std::optional<std::string> known_shared_secret(const database::PostgresAddress& address) {
  if (address.url.empty()) return std::nullopt;
  return secret_of(*database::DatabaseAddress(address).open());
}

}  // namespace unwrapd::server::access
