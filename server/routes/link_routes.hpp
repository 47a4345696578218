#pragma once
// Signed links to what a job has, and upload tickets: what a holder of an API key gives to somebody
// without one, such as a page in a browser.

#include <string>
#include <vector>

#include "server/routes/job_routes.hpp"

namespace unwrapd::server::routes {

/// The links of a job, each signed for this caller's key and open for a day.
api::Json signed_links(const access::LinkSigner& signer, const std::string& id,
                       const http::Caller& caller);

/// GET /v1/jobs/{id}/link and POST /v1/tickets.
void add_link_routes(std::vector<http::Route>& routes, const JobServices& services);

}  // namespace unwrapd::server::routes
