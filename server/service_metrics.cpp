#include "server/service_metrics.hpp"

#include <string_view>

namespace unwrapd::server {

void tell_jobs(Metrics& metrics, jobs::JobQueue& queue) {
  metrics.tell(Metric::jobs, {{"state", "queued"}}, [&queue] { return queue.counts().waiting; });
  metrics.tell(Metric::jobs, {{"state", "running"}}, [&queue] { return queue.counts().running; });
  metrics.tell(Metric::waiting_seconds, {}, [&queue] { return queue.waiting_seconds(); });
  const auto tell_affinity = [&](std::string_view outcome, auto count) {
    metrics.tell(Metric::cache_requests, {{"cache", "node"}, {"outcome", outcome}}, count);
  };
  tell_affinity("hit", [&queue] { return queue.affinity().hits; });
  tell_affinity("miss", [&queue] { return queue.affinity().misses; });
  const auto tell_bundles = [&](std::string_view outcome, const auto& count) {
    metrics.tell(Metric::shared_bundles, {{"outcome", outcome}}, [&count] { return count.load(); });
  };
  const jobs::SharingCounts& shared = queue.sharing().counts();
  tell_bundles("offered", shared.offered);
  tell_bundles("helped", shared.helped);
  tell_bundles("found", shared.found);
  tell_bundles("lost", shared.lost);
}

void tell_store(Metrics& metrics, blobs::BlobStore& blobs, const std::filesystem::path& root,
                webhooks::Webhooks& webhooks) {
  metrics.tell(Metric::webhooks_due, {}, [&webhooks] { return webhooks.due_count(); });
  metrics.tell(Metric::stored_bytes, {}, [&blobs] { return blobs.room().used_bytes(); });
  metrics.tell(Metric::free_bytes, {}, [root] {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(root, error);
    return error ? 0.0 : static_cast<double>(space.available);
  });
}

void tell_connections(Metrics& metrics, const http::HttpServer& http) {
  metrics.tell(Metric::connections, {{"state", "parked"}}, [&http] { return http.parked(); });
  metrics.tell(Metric::connections, {{"state", "served"}},
               [&http] { return http.open() - http.parked(); });
}

void tell_caches(Metrics& metrics, const work::SolverCache& solver, const MadeFiles& files) {
  const auto tell_asked = [&](std::string_view cache, auto hits, auto misses) {
    metrics.tell(Metric::cache_requests, {{"cache", cache}, {"outcome", "hit"}}, hits);
    metrics.tell(Metric::cache_requests, {{"cache", cache}, {"outcome", "miss"}}, misses);
  };
  const auto tell_files = [&](std::string_view cache, const FileCounts* of) {
    tell_asked(
        cache, [of] { return of->hits.load(); }, [of] { return of->misses.load(); });
    metrics.tell(Metric::made_bytes, {{"cache", cache}}, [of] { return of->bytes.load(); });
  };
  tell_asked(
      "solver", [&solver] { return solver.counters().hits; },
      [&solver] { return solver.counters().misses; });
  metrics.tell(Metric::cache_bytes, {{"cache", "solver"}},
               [&solver] { return solver.counters().bytes; });
  tell_files("result", files.results);
  tell_files("picture", files.pictures);
  tell_files("analysis", files.analyses);
}

}  // namespace unwrapd::server
