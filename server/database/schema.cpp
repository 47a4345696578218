#include "server/database/schema.hpp"

#include "core/base/error.hpp"
#include "server/database/schema_steps.hpp"

namespace unwrapd::server::database {

bool has_tables(const Database& database) { return database.version() > 0; }

void refuse_newer(const Database& database) {
  const std::int64_t found = database.version();
  if (found >= 0 && found <= kSchemaVersion) return;
  throw Error(
      ErrorCode::storage_failed,
      "The job store is of another version (schema " + std::to_string(found) +
          "): start the version that wrote it, or choose another --data directory or --database.");
}

void require_current(const Database& database) {
  refuse_newer(database);
  if (const std::int64_t found = database.version(); found < kSchemaVersion) {
    throw Error(ErrorCode::storage_failed, "The job store is of an older version (schema " +
                                               std::to_string(found) +
                                               "): start this version's server on it once.");
  }
}

void migrate(Database& database, std::optional<std::int64_t> last) {
  refuse_newer(database);
  const std::int64_t end = last.value_or(kSchemaVersion);
  while (database.version() < end)
    database.transact([&] {
      database.lock_version();
      if (database.version() >= end) return;
      const std::int64_t next = database.version() + 1;
      if (const std::string step = database.step_to(next); !step.empty()) database.run(step);
      database.set_version(next);
    });
}

}  // namespace unwrapd::server::database
