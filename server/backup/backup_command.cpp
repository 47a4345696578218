#include "server/backup/backup_command.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <string>

#include "core/base/error.hpp"
#include "server/backup/backup.hpp"
#include "server/backup/move_rows.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::backup {
namespace {

constexpr std::array<std::string_view, 4> kCommands = {"backup", "restore", "check", "move"};
constexpr int kFailed = 1;
constexpr int kDamaged = 3;

struct Asked {
  std::string data = "data";
  std::string database;
  std::string backup;
};

CLI::App* any_command(CLI::App& app, const std::string& name, const std::string& what,
                      Asked& asked) {
  CLI::App* found = app.add_subcommand(name, what);
  found->add_option("--data", asked.data, "Directory of jobs and results")
      ->envname("UNWRAPD_DATA")
      ->capture_default_str();
  return found;
}

CLI::App* command(CLI::App& app, const std::string& name, const std::string& what, Asked& asked) {
  CLI::App* found = any_command(app, name, what, asked);
  found->add_option("--database", asked.database, "Of a server with a PostgreSQL database: refused")
      ->envname("UNWRAPD_DATABASE");
  return found;
}

/// The files of a data directory are half of such a store.
void require_sqlite(const Asked& asked) {
  if (asked.database.empty()) return;
  throw Error(
      ErrorCode::invalid_option,
      "The rows of this store are in PostgreSQL, which has its own tools. To back up: first "
      "pg_dump --format=custom the database, then copy the data directory. To restore: "
      "pg_restore into an empty database, and put the directory back. To check: "
      "pg_amcheck. See docs/postgresql.md.");
}

int tell(const std::string& done, const StoreReport& report) {
  std::printf("%s: %lld jobs and meshes, %lld files, %lld bytes\n", done.c_str(),
              static_cast<long long>(report.jobs), static_cast<long long>(report.files),
              static_cast<long long>(report.bytes));
  for (const std::string& notice : report.notices) std::printf("note: %s\n", notice.c_str());
  for (const std::string& what : report.damaged)
    std::fprintf(stderr, "damaged: %s\n", what.c_str());
  return report.damaged.empty() ? 0 : kDamaged;
}

}  // namespace

bool is_backup_command(std::string_view word) {
  return std::ranges::find(kCommands, word) != kCommands.end();
}

int run_backup_command(int argc, const char* const* argv) {
  CLI::App app("Copies and checks data directories. Run these commands as the server's user.",
               "unwrapd");
  app.require_subcommand(1);
  Asked asked;
  int code = 0;
  CLI::App* backup = command(app, "backup",
                             "Copy a data directory, also while a server runs on it; exits with 3 "
                             "if damaged files were left out",
                             asked);
  backup->add_option("DEST", asked.backup, "Folder of the new backup; it must not exist")
      ->required();
  backup->callback([&] {
    require_sqlite(asked);
    code = tell("backed up", back_up(asked.data, asked.backup));
  });
  CLI::App* restoring = command(
      app, "restore",
      "Create a data directory from a complete backup; --data must be empty or missing", asked);
  restoring->add_option("BACKUP", asked.backup, "Folder made by unwrapd backup")->required();
  restoring->callback([&] {
    require_sqlite(asked);
    code = tell("restored", restore(asked.backup, asked.data));
  });
  command(app, "check",
          "Read every file of a data directory, also while a server runs on it, or of a backup; "
          "exits with 3 if anything is damaged",
          asked)
      ->callback([&] {
        require_sqlite(asked);
        code = tell("checked", check_store(asked.data));
      });
  CLI::App* moving = any_command(app, "move",
                                 "Move the rows of a data directory to an empty PostgreSQL "
                                 "database, while no server runs; files stay in the directory",
                                 asked);
  moving->add_option("--database", asked.database, "URL of that database")
      ->envname("UNWRAPD_DATABASE")
      ->required();
  moving->callback([&] {
    const StoreReport report = move_rows(asked.data, {.url = asked.database});
    std::printf("moved: %lld jobs and meshes; start the server with --database from now on\n",
                static_cast<long long>(report.jobs));
  });
  try {
    app.parse(argc, argv);
    return code;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "unwrapd %s: %s\n", argv[1], reason_of(error).c_str());
    return kFailed;
  }
}

}  // namespace unwrapd::server::backup
