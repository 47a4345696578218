#include "server/http/access_log.hpp"

#include <cmath>

namespace unwrapd::server::http {
namespace {

void count(const Exchanged& done, Metrics& metrics) {
  const std::string_view route = done.route.empty() ? "none" : done.route;
  const std::string status = std::to_string(done.status);
  const Labels labels = {{"method", done.method}, {"route", route}, {"status", status}};
  metrics.count(Metric::requests, labels);
  metrics.observe(Metric::request_seconds, {{"route", route}}, done.seconds);
  metrics.count(Metric::received_bytes, {}, static_cast<double>(done.received_bytes));
  metrics.count(Metric::sent_bytes, {}, static_cast<double>(done.sent_bytes));
  if (!done.problem.empty()) metrics.count(Metric::errors, {{"code", done.problem}});
}

}  // namespace

void log_request(const Exchanged& done, const Log& log, LogLevel level, Metrics& metrics) {
  count(done, metrics);
  api::Json line = {{"method", done.method},
                    {"path", done.path},
                    {"status", done.status},
                    {"client", done.client},
                    {"received", done.received_bytes},
                    {"sent", done.sent_bytes},
                    {"ms", std::round(done.seconds * 1e6) / 1e3}};
  if (!done.problem.empty()) line["problem"] = done.problem;
  log.write(level, "request", line);
}

}  // namespace unwrapd::server::http
