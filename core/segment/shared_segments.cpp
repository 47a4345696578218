#include "core/segment/shared_segments.hpp"

#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/base/shared_work.hpp"
#include "core/charts/packed_chart.hpp"

namespace unwrapd::segment {
namespace {

constexpr double kBundles = 24;  // of the least work that is shared, about five seconds

std::vector<double> faces_of(std::span<const ComponentJob> jobs) {
  std::vector<double> faces;
  for (const ComponentJob& job : jobs)
    faces.push_back(static_cast<double>(job.component->mesh.faces.size()));
  return faces;
}

/// Of all that charts_within_bound() reads.
Digest key_of(std::span<const ComponentJob> jobs, const SharedCache& digests) {
  BytePacker key;
  key.add_text("segment");
  for (const auto& [component, rules] : jobs) {
    const auto& [segment, symmetry, may_stay] = rules;
    const auto& [bound, most, page_area, effort, is_quick, on_progress, stop] = segment;
    BytePacker bytes;
    charts::pack(bytes, *component);
    key.add(digest_of(digests, bytes.take())).add(symmetry).add(may_stay);
    key.add(bound).add(most).add(page_area).add(effort).add(is_quick);
  }
  return digest_of(digests, key.take());
}

void pack(BytePacker& bytes, const ComponentCharts& parts) {
  bytes.add(std::uint8_t{parts.is_rough}).add(static_cast<std::uint32_t>(parts.charts.size()));
  for (const charts::Chart& chart : parts.charts) charts::pack(bytes, chart);
}

ComponentCharts unpack(ByteUnpacker& bytes, const charts::Chart& component) {
  ComponentCharts parts{.charts = {}, .is_rough = bytes.next<std::uint8_t>() != 0};
  charts::PartReader reader(component);
  for (auto left = bytes.next<std::uint32_t>(); left > 0; --left)
    parts.charts.push_back(reader.next(bytes));
  reader.require_all();
  return parts;
}

}  // namespace

std::vector<ComponentCharts> charts_made_together(
    std::span<const ComponentJob> jobs, const std::function<void(std::size_t job)>& on_done,
    Executor& executor) {
  const SharedCache* digests = executor.shared_cache();
  auto bundles = bundled(executor.shared_work(), faces_of(jobs), kBundles);
  if (!bundles || digests == nullptr) return {};
  SharedStage& stage = *bundles;
  stage.key = key_of(jobs, *digests);
  std::vector<ComponentCharts> made(jobs.size());
  const auto each = [&](int bundle, const auto& act) {
    const auto b = static_cast<std::size_t>(bundle);
    for (std::size_t k = stage.begin[b]; k < stage.begin[b + 1]; ++k) act(k);
  };
  const auto make = [&](int bundle) {
    each(bundle, [&](std::size_t k) {
      throw_if_cancelled(jobs[k].rules.segment.stop);
      made[k] = charts_within_bound(*jobs[k].component, jobs[k].rules, executor);
      on_done(k);
    });
  };
  const auto packed = [&](int bundle) {
    BytePacker bytes;
    each(bundle, [&](std::size_t k) { pack(bytes, made[k]); });
    return bytes.take();
  };
  const auto take = [&](int bundle, std::string_view text) {
    ByteUnpacker bytes(text);
    each(bundle, [&](std::size_t k) { made[k] = unpack(bytes, *jobs[k].component); });
    if (!bytes.empty()) throw Error(ErrorCode::internal, "A bundle is too long.");
    each(bundle, on_done);
  };
  make_together(*executor.shared_work(), *digests, stage, {make, packed, take});
  return made;
}

}  // namespace unwrapd::segment
