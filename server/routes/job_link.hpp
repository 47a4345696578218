#pragma once
// GET /v1/jobs/{id}/link: an address that opens one file of a job without an API key, for a time.

#include "server/access/signed_link.hpp"
#include "server/http/http.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server {

/// Parameters file (result, report, layout.svg, layout.png or preview.png; default result) and
/// seconds (1 to 604800; default 3600). Throws Error{invalid_option}.
Response get_link(const JobRecord& job, const LinkSigner& links, const Request& request);

}  // namespace unwrapd::server
