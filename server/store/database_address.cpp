#include "server/store/database_address.hpp"

#include "server/store/sqlite_database.hpp"

namespace unwrapd::server::store {

std::unique_ptr<Database> DatabaseAddress::open() const {
  return std::make_unique<SqliteDatabase>(file_);
}

}  // namespace unwrapd::server::store
