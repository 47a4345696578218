#include "core/pipeline/map_all.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/shared_work.hpp"
#include "core/charts/packed_chart.hpp"
#include "core/pipeline/map_chart.hpp"
#include "core/pipeline/packed_map.hpp"

namespace unwrapd::pipeline {
namespace {

constexpr double kBundles = 8;  // of the least work that is shared, about a second

std::vector<double> faces_of(std::span<const ChartJob> jobs) {
  std::vector<double> faces;
  for (const ChartJob& job : jobs)
    faces.push_back(static_cast<double>(job.chart->mesh.faces.size()));
  return faces;
}

/// Of all that map_chart() reads, but for the job's own options. One of them may be another than
/// the job's (try_tighter_bounds).
Digest key_of(std::span<const ChartJob> jobs, const UnwrapOptions& options,
              const SharedCache& digests) {
  BytePacker key;
  key.add_text("map").add(options.max_distortion.value_or(0));
  for (const ChartJob& job : jobs) {
    BytePacker bytes;
    charts::pack(bytes, *job.chart);
    key.add(digest_of(digests, bytes.take()));
  }
  return digest_of(digests, key.take());
}

/// Nothing where the work is not shared: that of charts under position constraints never is.
std::optional<SharedStage> stage_of(std::span<const ChartJob> jobs, const Executor& executor) {
  const bool is_free =
      std::ranges::all_of(jobs, [](const ChartJob& job) { return job.page.empty(); });
  if (!is_free || executor.shared_cache() == nullptr) return std::nullopt;
  return bundled(executor.shared_work(), faces_of(jobs), kBundles);
}

/// Maps the charts of bundles, made here or taken from others.
class SharedMaps {
 public:
  SharedMaps(std::span<const ChartJob> jobs, const UnwrapOptions& options, ChartProgress& progress,
             Executor& executor, SharedStage stage)
      : jobs_(jobs),
        options_(options),
        progress_(progress),
        executor_(executor),
        digests_(*executor.shared_cache()),
        stage_(std::move(stage)),
        made_(jobs.size()) {
    stage_.key = key_of(jobs, options, digests_);
  }

  std::vector<std::vector<std::vector<MappedChart>>> run() {
    make_together(
        *executor_.shared_work(), digests_, stage_,
        {[this](int bundle) { make(bundle); }, [this](int bundle) { return packed(bundle); },
         [this](int bundle, std::string_view bytes) { take(bundle, bytes); }});
    std::vector<std::vector<std::vector<MappedChart>>> maps;
    for (ToldMaps& told : made_) maps.push_back(std::move(told.maps));
    return maps;
  }

 private:
  template <class Act>
  void each(int bundle, const Act& act) const {
    const auto b = static_cast<std::size_t>(bundle);
    for (std::size_t k = stage_.begin[b]; k < stage_.begin[b + 1]; ++k) act(k);
  }

  void make(int bundle) {
    each(bundle, [this](std::size_t k) {
      made_[k] = {};
      progress_.record_to(&made_[k].events);
      made_[k].maps = map_chart(jobs_[k], options_, progress_, executor_);
      progress_.record_to(nullptr);
    });
  }

  [[nodiscard]] std::string packed(int bundle) const {
    BytePacker bytes;
    each(bundle, [&](std::size_t k) { pack(bytes, jobs_[k], made_[k]); });
    return bytes.take();
  }

  /// Nothing is told before all of it was read.
  void take(int bundle, std::string_view text) {
    ByteUnpacker bytes(text);
    const std::size_t map_count = lambdas_of(options_).size();
    each(bundle, [&](std::size_t k) { made_[k] = unpack_maps(bytes, jobs_[k], map_count); });
    if (!bytes.empty()) throw Error(ErrorCode::internal, "A bundle is too long.");
    each(bundle, [&](std::size_t k) {
      progress_.begin_chart(jobs_[k].chart->mesh.faces.size(), map_count);
      progress_.tell_again(made_[k].events, options_.stop);
      progress_.end_chart();
    });
  }

  const std::span<const ChartJob> jobs_;
  const UnwrapOptions& options_;
  ChartProgress& progress_;
  Executor& executor_;
  const SharedCache& digests_;
  SharedStage stage_;
  std::vector<ToldMaps> made_;
};

}  // namespace

std::vector<std::vector<std::vector<MappedChart>>> map_all(std::span<const ChartJob> jobs,
                                                           const UnwrapOptions& options,
                                                           ChartProgress& progress,
                                                           Executor& executor) {
  if (auto stage = stage_of(jobs, executor))
    return SharedMaps(jobs, options, progress, executor, std::move(*stage)).run();
  std::vector<std::vector<std::vector<MappedChart>>> maps;
  for (const ChartJob& job : jobs) maps.push_back(map_chart(job, options, progress, executor));
  return maps;
}

}  // namespace unwrapd::pipeline
