#pragma once
// GET /v1/jobs/{id}/link: an address that opens one file of a job without an API key, for a time.

#include "server/access/signed_link.hpp"
#include "server/http/http.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::routes {

/// Parameters file (result, report, layout.svg, layout.png or preview.png; default result) and
/// seconds (1 to 604800; default 3600). Throws Error{invalid_option}.
http::Response get_link(const store::JobRecord& job, const access::LinkSigner& links,
                        const http::Request& request);

}  // namespace unwrapd::server::routes
