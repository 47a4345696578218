#pragma once
// The settings of each part of the server, made from those of the server.

#include <cstdint>

#include "server/base/log.hpp"
#include "server/base/metrics.hpp"
#include "server/config/config.hpp"
#include "server/http/http_server.hpp"
#include "server/results/render_limiter.hpp"
#include "server/results/result_store.hpp"
#include "server/work/job_process.hpp"
#include "server/work/job_worker.hpp"
#include "server/work/solver_cache.hpp"

namespace unwrapd::server::config {

http::HttpConfig http_config(const Config& config);
http::HttpConfig admin_config(const http::Address& address);

/// How long jobs that were told to stop may go on at the end of the server.
std::chrono::seconds most_stopping(const Config& config);

/// Tells whether jobs have processes, and why not if they should.
void tell_isolation(const work::Isolation& isolation, const Config& config, const Log& log,
                    Metrics& metrics);

/// Warns if no client can use the server, which would look as if it worked.
void warn_without_keys(const Config& config, bool has_keys, const Log& log);

/// Processes for all jobs if they can be had, of which this makes sure; when they are turned off,
/// for the suspects alone. Throws Error where they are asked for and cannot be had.
work::Isolation isolation_of(const Config& config, const work::SolverCache& cache,
                             const work::WorkerFunctions& functions);

/// Requests that may wait for the ends of jobs at a time. As many may wait for pictures.
int most_waiting(const Config& config);

/// Requests that wait for a picture or make one hold a thread, like those that wait for a job:
/// http_config() adds that many threads.
results::RenderLimits render_limits(const Config& config, std::size_t memory_bytes);

results::ResultsFrom results_from(const Config& config);

/// Open files without which no server can work.
inline constexpr std::int64_t kFewestDescriptors = 64;

/// The most connections to the main port if the process may open so many files. Connections get
/// what is left when enough is kept back for stores, the files of requests and jobs, workers and
/// the admin port: idle clients then take no descriptor that an answer needs. Throws
/// Error{internal} for fewer than kFewestDescriptors.
int connections_within(std::int64_t files, const Config& config);

}  // namespace unwrapd::server::config
