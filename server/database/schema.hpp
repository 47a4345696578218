#pragma once
// The tables of the job store, and the way from every older version of them to this one. A step is
// one transaction with the version's number: a crash in the middle of it leaves the old version
// whole. There is no way back: an older unwrapd refuses a newer file rather than guess.

#include <cstdint>
#include <optional>

#include "server/database/database.hpp"

namespace unwrapd::server::database {

/// Whether any version has made its tables in this file.
bool has_tables(const Database& database);

/// Throws Error{storage_failed} when they are of a later version than this program's.
void refuse_newer(const Database& database);

/// Throws Error{storage_failed} when they are of any other version.
void require_current(const Database& database);

/// Brings the tables to this version, from an empty file or one of any version before. last: the
/// version to end at, where that is not this one. Throws Error{storage_failed} when they are of a
/// later version.
void migrate(Database& database, std::optional<std::int64_t> last = {});

}  // namespace unwrapd::server::database
