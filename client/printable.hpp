#pragma once
// Makes a server's text safe for a terminal.

#include <string>

namespace unwrapd::client {

/// Replaces control characters (C0, DEL and C1), which could move the cursor or give commands, by
/// "?".
std::string printable(std::string text);

}  // namespace unwrapd::client
