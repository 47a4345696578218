#pragma once
// GET /v1/jobs/{id}/layout.svg, layout.png and preview.png.

#include <vector>

#include "server/http/router.hpp"
#include "server/results/picture_store.hpp"
#include "server/store/job_store.hpp"

namespace unwrapd::server::routes {

void add_picture_routes(std::vector<http::Route>& routes, store::JobStore& jobs,
                        results::PictureStore& pictures);

/// What a query string asks of a picture of this kind. Throws Error{invalid_option} with the
/// pointer "/name" of the first parameter that is unknown, given twice or out of range.
work::Picture picture_of(work::PictureKind kind,
                         const std::multimap<std::string, std::string>& query);

}  // namespace unwrapd::server::routes
