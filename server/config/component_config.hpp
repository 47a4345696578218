#pragma once
// What the parts of the server are told, made of what the server is told.

#include "server/base/log.hpp"
#include "server/base/metrics.hpp"
#include "server/config/config.hpp"
#include "server/http/http_server.hpp"
#include "server/results/render_limiter.hpp"
#include "server/work/job_process.hpp"
#include "server/work/solver_cache.hpp"
#include "server/work/worker_functions.hpp"

namespace unwrapd::server::config {

http::HttpConfig http_config(const Config& config);
http::HttpConfig admin_config(const Address& address);

/// How long jobs that were told to stop may go on at the end of the server.
std::chrono::seconds most_stopping(const Config& config);

/// Tells whether jobs have processes, and why not if they should.
void tell_isolation(const work::Isolation& isolation, const Config& config, const Log& log,
                    Metrics& metrics);

/// Processes for all jobs if they can be had, of which this makes sure; when they are turned off,
/// for the suspects alone. Throws Error where they are asked for and cannot be had.
work::Isolation isolation_of(const Config& config, const work::SolverCache& cache,
                             const work::WorkerFunctions& functions);

/// Requests that may wait for the ends of jobs at a time. As many may wait for pictures.
int most_waiting(const Config& config);

/// Who waits for a picture, or makes one, holds a thread, as who waits for a job does:
/// http_config() has so many more.
results::RenderLimits render_limits(const Config& config, std::size_t memory_bytes);

}  // namespace unwrapd::server::config
