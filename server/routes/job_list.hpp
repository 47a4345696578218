#pragma once
// GET /v1/jobs: the caller's jobs, the newest first, in pages.

#include "server/http/http.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::routes {

/// Parameters state, limit (1 to 200) and cursor (the `next` of the page before). Throws
/// Error{invalid_option} naming the parameter that is unknown, given twice or out of range.
http::Response list_jobs(store::JobStore& store, const http::Request& request);

}  // namespace unwrapd::server::routes
