#pragma once
// Rows of the jobs table as records and back.

#include <string>
#include <string_view>
#include <vector>

#include "server/store/database.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::store {

/// "SELECT <all columns> FROM jobs <rest>".
std::string select_jobs(std::string_view rest);

/// " RETURNING <all columns>".
std::string returning_jobs();

/// All rows of a statement with these columns; of one that cannot be read `unreadable` says why.
std::vector<JobRecord> job_rows(Statement& statement);

/// JSON as text; what is not UTF-8 in it is replaced.
std::string text_of(const api::Json& json);

api::Json buffers_json(const std::vector<StoredBuffer>& buffers);

}  // namespace unwrapd::server::store
