#pragma once
// The secret of all nodes that share a store: each opens the links of the others, and signs the
// same webhooks.

#include <optional>
#include <string>

#include "server/database/database_address.hpp"

namespace unwrapd::server::access {

/// The secret in the database; own becomes it where there is none yet.
std::string shared_secret(const database::DatabaseAddress& address, const std::string& own);
/// The same; nothing where no node has shared one, or in a file.
std::optional<std::string> known_shared_secret(const database::PostgresAddress& address);

}  // namespace unwrapd::server::access
