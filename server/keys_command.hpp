#pragma once
// `unwrapd keys add|list|remove|webhook-secret`: the API keys of a data directory, also while a
// server runs on it.

namespace unwrapd::server {

/// argv[1] is "keys". Returns the exit code: 0, or after a message 1 or that of a wrong command
/// line.
int run_keys_command(int argc, const char* const* argv);

}  // namespace unwrapd::server
