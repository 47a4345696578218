#pragma once
// What is told of every request once it is answered: a line in the log, and the counts. The line
// has the path without the query, which may hold what is not for logs.

#include "server/base/log.hpp"
#include "server/base/metrics.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {

/// level: of the line.
void log_request(const Exchanged& done, const Log& log, LogLevel level, Metrics& metrics);

}  // namespace unwrapd::server::http
