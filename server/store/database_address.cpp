#include "server/store/database_address.hpp"

#include "server/store/postgres_database.hpp"
#include "server/store/sqlite_database.hpp"

namespace unwrapd::server::store {

DatabaseAddress::DatabaseAddress(std::filesystem::path file)
    : open_([file = std::move(file)] { return std::make_shared<SqliteDatabase>(file); }) {}

DatabaseAddress::DatabaseAddress(PostgresAddress postgres)
    : open_([address = std::move(postgres)] {
        return std::make_shared<PostgresDatabase>(address);
      }) {}

}  // namespace unwrapd::server::store
