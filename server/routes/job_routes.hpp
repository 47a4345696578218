#pragma once
// The calls on jobs: thin handlers that turn a Request into one call and its value into a Response.

#include <functional>
#include <vector>

#include "server/access/signed_link.hpp"
#include "server/base/waiters.hpp"
#include "server/http/router.hpp"
#include "server/jobs/job_queue.hpp"
#include "server/results/result_store.hpp"
#include "server/routes/event_streams.hpp"
#include "server/store/job_store.hpp"
#include "server/uploads/submissions.hpp"

namespace unwrapd::server {

/// What the handlers work on; all of it outlives the routes.
struct JobServices {
  JobStore& store;
  JobQueue& queue;
  BlobStore& blobs;
  EventFeed& events;
  EventStreams& streams;
  Submissions& submissions;
  ResultStore& results;
  const LinkSigner& links;
  const api::Limits& limits;
  Waiters& waiters;
};

/// The job of the path. Throws Error{not_found} when there is none, or none of the caller's.
JobRecord find_job(JobStore& store, const Request& request);

/// What is answered with files of the job of the path. Throws not_found, or what require_result()
/// throws, when they went meanwhile.
Response answer_with_files(JobStore& store, const Request& request,
                           const std::function<Response(const JobRecord& job)>& answer);

/// POST /v1/jobs and everything below /v1/jobs/{id} but the pictures.
void add_job_routes(std::vector<Route>& routes, const JobServices& services);

/// POST /v1/unwrap.
void add_unwrap_route(std::vector<Route>& routes, const JobServices& services);

}  // namespace unwrapd::server
