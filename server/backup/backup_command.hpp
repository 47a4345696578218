#pragma once
// unwrapd backup, restore and check: copies of a data directory, also while a server runs on it.

#include <string_view>

namespace unwrapd::server::backup {

[[nodiscard]] bool is_backup_command(std::string_view word);

/// argv[1] is one of them. Returns the exit code: 0; 1 when nothing was made or read, which stderr
/// tells why; 3 when damage was found, which stderr tells of.
int run_backup_command(int argc, const char* const* argv);

}  // namespace unwrapd::server::backup
