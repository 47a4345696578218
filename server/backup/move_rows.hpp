#pragma once
// Moves the rows of a data directory from its files of SQLite to a PostgreSQL database. The files
// of jobs stay where they are.

#include <filesystem>

#include "server/backup/backup.hpp"
#include "server/database/postgres_address.hpp"

namespace unwrapd::server::backup {

/// All rows, in one transaction; then jobs.sqlite and keys.sqlite get the ending .moved. Jobs that
/// were running wait again. Throws Error, and nothing is moved: not_found where there is no store,
/// invalid_option for a database that has jobs, meshes or keys, storage_failed for a directory in
/// use.
StoreReport move_rows(const std::filesystem::path& data, const database::PostgresAddress& to);

}  // namespace unwrapd::server::backup
