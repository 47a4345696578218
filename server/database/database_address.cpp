#include "server/database/database_address.hpp"

#include "server/database/postgres_database.hpp"
#include "server/database/sqlite_database.hpp"

namespace unwrapd::server::database {

DatabaseAddress::DatabaseAddress(std::filesystem::path file)
    : open_([file = std::move(file)] { return std::make_shared<SqliteDatabase>(file); }) {}

DatabaseAddress::DatabaseAddress(PostgresAddress postgres)
    : open_([address = std::move(postgres)] {
        return std::make_shared<PostgresDatabase>(address);
      }) {}

}  // namespace unwrapd::server::database
