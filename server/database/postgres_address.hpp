#pragma once

#include <chrono>
#include <string>

namespace unwrapd::server::database {

/// Where a PostgreSQL database is.
struct PostgresAddress {
  std::string url;  ///< "postgres://user@host/name"; may have a password
  /// The id of this node, where other nodes work on the same store. Empty: none may.
  std::string node = {};
  /// How long a call waits for a connection that was lost while it used it.
  std::chrono::milliseconds patience = std::chrono::seconds(5);
};

}  // namespace unwrapd::server::database
