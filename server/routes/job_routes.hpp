#pragma once
// The calls on jobs: thin handlers that turn a Request into one call and its value into a Response.

#include <functional>
#include <vector>

#include "server/access/signed_link.hpp"
#include "server/base/concurrency_limit.hpp"
#include "server/http/router.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/results/result_store.hpp"
#include "server/routes/event_streams.hpp"
#include "server/store/job_store.hpp"
#include "server/uploads/submissions.hpp"

namespace unwrapd::server::routes {

/// What the handlers work on; all of it outlives the routes.
struct JobServices {
  store::JobStore& store;
  jobs::JobQueue& queue;
  blobs::BlobStore& blobs;
  jobs::EventFeed& events;
  EventStreams& streams;
  uploads::Submissions& submissions;
  results::ResultStore& results;
  const access::LinkSigner& links;
  const api::Limits& limits;
  ConcurrencyLimit& waiters;
};

/// The job of the path. Throws Error{not_found} when there is none, or none of the caller's.
store::JobRecord find_job(store::JobStore& store, const http::Request& request);

/// What is answered with files of a job. Throws not_found, or what require_result() throws, when
/// they went meanwhile.
http::Response answer_with_files(
    store::JobStore& store, const store::JobRecord& job,
    const std::function<http::Response(const store::JobRecord& job)>& answer);

/// POST /v1/jobs and everything below /v1/jobs/{id} but pictures and links.
void add_job_routes(std::vector<http::Route>& routes, const JobServices& services);

/// POST /v1/unwrap.
void add_unwrap_route(std::vector<http::Route>& routes, const JobServices& services);

}  // namespace unwrapd::server::routes
