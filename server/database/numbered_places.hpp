#pragma once

#include <string>
#include <string_view>

namespace unwrapd::server::database {

/// "?" and "?2" of SQLite's texts as "$1" and "$2" of PostgreSQL's.
std::string with_dollars(std::string_view sql);

}  // namespace unwrapd::server::database
