#include "server/jobs/job_metrics.hpp"

namespace unwrapd::server::jobs {

void JobMetrics::see(const api::Event& event) {
  if (event.name == "iteration") {
    metrics_.count(Metric::iterations);
  } else if (event.name == "stage") {
    enter(event.data.at("name"));
  } else if (api::is_last(event)) {
    enter({});
    metrics_.count(Metric::jobs_ended, {{"state", event.name}});
    if (event.name == "failed") {
      const std::string& code = event.data.at("problem").at("code").get_ref<const std::string&>();
      metrics_.count(Metric::job_errors, {{"code", code}});
    }
  }
}

void JobMetrics::enter(const std::string& stage) {
  if (stage == stage_) return;  // another chart
  const auto now = std::chrono::steady_clock::now();
  const std::chrono::duration<double> spent = now - since_;
  metrics_.observe(Metric::stage_seconds, {{"stage", stage_}}, spent.count());
  stage_ = stage;
  since_ = now;
}

}  // namespace unwrapd::server::jobs
