#pragma once
// What a server says, as it may be written to a terminal.

#include <string>

namespace unwrapd::client {

/// Control characters (C0, DEL and C1), by which a text would move the cursor or give commands,
/// become "?".
std::string printable(std::string text);

}  // namespace unwrapd::client
