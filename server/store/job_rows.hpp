#pragma once
// Rows of the jobs table as records and back.

#include <string>
#include <string_view>
#include <vector>

#include "server/database/database.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::store {

/// "SELECT <all columns> FROM jobs <rest>".
std::string select_jobs(std::string_view rest);

/// " RETURNING <all columns>".
std::string returning_jobs();

/// All rows of a statement with these columns; of one that cannot be read `unreadable` says why.
std::vector<JobRecord> job_rows(database::Statement& statement);

api::Json buffers_json(const std::vector<StoredBuffer>& buffers);

}  // namespace unwrapd::server::store
