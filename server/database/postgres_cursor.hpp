#pragma once

#include <memory>
#include <string_view>

#include "server/database/postgres_database.hpp"

namespace unwrapd::server::database {

/// A statement of this database, which it must not outlive.
std::unique_ptr<Cursor> postgres_cursor(const PostgresDatabase& database, std::string_view sql);

}  // namespace unwrapd::server::database
