#include "server/backup/move_rows.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/access/key_store.hpp"
#include "server/base/files.hpp"
#include "server/database/schema.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/store/data_directory.hpp"

namespace unwrapd::server::backup {
namespace {

namespace fs = std::filesystem;

/// What triggers keep is not copied: it follows from the others.
constexpr std::array kJobTables = {"written", "jobs", "meshes", "deliveries", "spent_tickets"};

struct Column {
  std::string name;
  bool is_number;
};

std::vector<Column> columns_of(const database::Database& database, const std::string& table) {
  database::Statement rows(database, "SELECT name, type FROM pragma_table_info(?)");
  rows.with(table);
  std::vector<Column> columns;
  while (rows.step()) columns.push_back({rows.text(0), rows.text(1) != "TEXT"});
  return columns;
}

std::string joined(const std::vector<Column>& columns) {
  std::string all;
  for (const Column& column : columns) all += (all.empty() ? "" : ", ") + column.name;
  return all;
}

/// A request without a name of its own has none, rather than an empty one.
std::string places_of(const std::vector<Column>& columns) {
  std::string all;
  for (const Column& column : columns)
    all += std::string(all.empty() ? "" : ", ") +
           (column.name == "request_key" ? "NULLIF(?, '')" : "?");
  return all;
}

/// Numbers of rows that the other engine gives next follow those that are there.
void raise_sequence(database::Database& to, const std::string& table) {
  database::Statement(to,
                      "SELECT setval(pg_get_serial_sequence(?1, 'seq'),"
                      " GREATEST((SELECT MAX(seq) FROM " +
                          table + "), 1))")
      .with(table)
      .run();
}

std::int64_t copy_table(const database::Database& from, database::Database& to,
                        const std::string& table) {
  const std::vector<Column> columns = columns_of(from, table);
  database::Statement rows(from, "SELECT " + joined(columns) + " FROM " + table);
  const std::string insert = "INSERT INTO " + table + " (" + joined(columns) +
                             ") OVERRIDING SYSTEM VALUE VALUES (" + places_of(columns) + ")";
  std::int64_t count = 0;
  for (; rows.step(); ++count) {
    database::Statement row(to, insert);
    for (int k = 0; k < static_cast<int>(columns.size()); ++k)
      columns[static_cast<std::size_t>(k)].is_number ? row.bind(k + 1, rows.number(k))
                                                     : row.bind(k + 1, rows.text(k));
    row.run();
  }
  if (count > 0 && !columns.empty() && columns.front().name == "seq") raise_sequence(to, table);
  return count;
}

void require_empty(const database::Database& to) {
  for (const char* table : {"jobs", "meshes", "keys"})
    if (database::number_of(to, "SELECT COUNT(*) FROM " + std::string(table)) > 0)
      throw Error(ErrorCode::invalid_option,
                  std::string("The database of --database has rows in its table ") + table +
                      "; give one that no unwrapd has used.");
}

void put_aside(const fs::path& file) {
  if (fs::exists(file)) fs::rename(file, fs::path(file) += ".moved");
}

}  // namespace

StoreReport move_rows(const fs::path& data, const database::PostgresAddress& to) {
  const fs::path jobs = data / store::kStoreFile;
  const fs::path keys = data / access::kKeysFile;
  if (!fs::is_regular_file(jobs))
    throw Error(ErrorCode::not_found,
                "There is no " + jobs.string() + "; give the --data directory of a server.");
  const store::DataLock lock(data);
  StoreReport report;
  {
    database::SqliteDatabase from(jobs);
    from.check(true);
    database::migrate(from);
    from.transact([&] { from.run("UPDATE jobs SET state = 'queued' WHERE state = 'running'"); });
    const std::shared_ptr<database::Database> there = database::DatabaseAddress(to).open();
    there->claim();
    database::migrate(*there);
    require_empty(*there);
    report.jobs = there->transact([&] {
      there->run("DELETE FROM written");
      std::int64_t count = 0;
      for (const std::string table : kJobTables) {
        const std::int64_t rows = copy_table(from, *there, table);
        if (table == "jobs" || table == "meshes") count += rows;
      }
      if (fs::exists(keys)) copy_table(database::SqliteDatabase(keys), *there, "keys");
      return count;
    });
  }
  for (const fs::path& file : {jobs, keys}) put_aside(file);
  sync_directory(data);
  return report;
}

}  // namespace unwrapd::server::backup
