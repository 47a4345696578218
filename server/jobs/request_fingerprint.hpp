#pragma once
// What a job was asked, so that the same is not done twice, and a name is not answered with what
// was asked by another.

#include <string>

#include "api/json.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::jobs {

/// The same for the same question: these options, and of what.
std::string request_fingerprint(const api::Json& options, const store::JobRecord& job);

/// The same for the same answer: of a job, its resolved options and the notes on those that it gave
/// without effect, which its report has, too.
std::string content_fingerprint(const store::JobRecord& job);

/// Whether two jobs of one name were asked the same. `sent` is about to be stored; where its sender
/// has chosen its id, that is part of the question. Of a job that was stored before questions were
/// noted (schema 6), the options are compared as they were resolved, but for members too long to be
/// in its row.
bool is_same_request(const store::JobRecord& stored, const store::JobRecord& sent);

}  // namespace unwrapd::server::jobs
