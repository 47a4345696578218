// Processes that work on one job together, here as threads: the result is that of one alone,
// whoever helps, is lost, or hands over what is damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "core/base/error.hpp"
#include "core/base/shared_work.hpp"
#include "tests/core/hard_shapes.hpp"
#include "tests/server/shared_jobs.hpp"

namespace unwrapd::server::work {
namespace {

/// Where the bundles of all processes lie.
class Exchange {
 public:
  struct Stage {
    int front = 0, back = 0;
    std::map<int, std::string> bundles;
  };

  std::mutex mutex;
  std::map<Digest, Stage> stages;
  int found = 0;
  bool waits_for_helpers = true;
  std::function<std::string(std::string)> damage = {};
};

class SharedInMemory final : public SharedWork {
 public:
  SharedInMemory(Exchange& exchange, bool is_helper) : exchange_(exchange), is_helper_(is_helper) {}

  std::optional<Claim> claim(const SharedStage& stage) override {
    const std::lock_guard lock(exchange_.mutex);
    Exchange::Stage& own = exchange_.stages[stage.key];
    if (own.front + own.back >= stage.bundle_count()) return std::nullopt;
    return Claim{is_helper_ ? stage.bundle_count() - ++own.back : own.front++};
  }
  void publish(const SharedStage& stage, int bundle, std::string_view bytes) override {
    const std::lock_guard lock(exchange_.mutex);
    exchange_.stages[stage.key].bundles[bundle] = bytes;
  }
  std::optional<std::string> obtain(const SharedStage& stage, int bundle) override {
    while (true) {
      {
        const std::lock_guard lock(exchange_.mutex);
        const auto& bundles = exchange_.stages[stage.key].bundles;
        if (const auto found = bundles.find(bundle); found != bundles.end()) {
          if (!is_helper_) ++exchange_.found;
          return exchange_.damage ? exchange_.damage(found->second) : found->second;
        }
        if (!exchange_.waits_for_helpers) return std::nullopt;
      }
      std::this_thread::yield();
    }
  }
  [[nodiscard]] double least_faces() const override { return 100; }
  void finish() override {
    if (is_helper_) throw Error(ErrorCode::cancelled, "");
  }

 private:
  Exchange& exchange_;
  const bool is_helper_;
};

class SharingThread final : public Executor {
 public:
  explicit SharingThread(SharedWork* work) : work_(work) {}
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    for (int block = 0; block < block_count; ++block) body(block);
  }
  [[nodiscard]] SharedCache* shared_cache() const override { return &cache_; }
  [[nodiscard]] SharedWork* shared_work() const override { return work_; }

 private:
  SharedWork* work_;
  mutable SolverCache cache_{kRoomForAll, 1};
};

/// Closed bodies and bumps.
Surfaces scene() {
  Surfaces surfaces;
  for (const int size : {5, 6, 7, 8}) {
    surfaces.push_back(shapes::surface_of(shapes::torus(size + 3, size)));
    surfaces.push_back(shapes::surface_of(bent(shapes::grid(size, size), 0.1 * size)));
  }
  return surfaces;
}

/// Disks that overlap themselves when they are mapped, so that the guarantee splits them.
Surfaces overlapping_disks() {
  Surfaces surfaces = {shapes::surface_of(shapes::fan(300))};
  for (const double turn : {7.0, 9.0, 12.0, 20.0})
    surfaces.push_back(shapes::surface_of(shapes::cone_sector(24, 6, 0.1, turn)));
  return surfaces;
}

struct Told {
  std::string answer;
  Index most_parts = 0;  ///< of a chart
  std::vector<std::string> events;
};

std::string numbers(Index chart, double fraction) {
  return std::to_string(chart) + " " + std::to_string(fraction);
}

/// A job and what it tells while its charts are solved. The shares of the job that segmenting tells
/// differ: it tells those of its own work.
Told run(const Surfaces& surfaces, const UnwrapOptions& options, SharedWork* work) {
  Told told;
  double last = 0;
  const auto is_forward = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  Progress progress;
  progress.on_stage = [&](const StageEvent& event) {
    is_forward(event.fraction);
    if (event.stage == Stage::solve || event.stage == Stage::untangle)
      told.events.push_back("stage " + numbers(event.chart, event.fraction));
  };
  progress.on_iteration = [&](const IterationEvent& event) {
    is_forward(event.fraction);
    told.events.push_back("iteration " + std::to_string(event.iteration) + " " +
                          std::to_string(event.energy) + " " +
                          numbers(event.chart, event.fraction));
  };
  SharingThread executor(work);
  for (const Unwrapped& map : unwrap_curve(surfaces, options, progress, executor)) {
    told.answer += encode_uvs(map.surfaces) + api::to_json(map.report, {}).dump();
    for (const ChartReport& chart : map.report.charts)
      told.most_parts = std::max(told.most_parts, chart.mending.parts);
  }
  return told;
}

/// A helper, until nothing is left to do.
void help(const Surfaces& surfaces, const UnwrapOptions& options, Exchange& exchange) {
  SharedInMemory work(exchange, true);
  SharingThread executor(&work);
  Progress progress;
  progress.on_iteration = [](const IterationEvent&) {};
  try {
    static_cast<void>(unwrap_curve(surfaces, options, progress, executor));
    FAIL() << "a helper has a result";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

Told run_with_helpers(const Surfaces& surfaces, const UnwrapOptions& options, int helpers,
                      Exchange& exchange) {
  std::vector<std::jthread> threads;
  for (int k = 0; k < helpers; ++k)
    threads.emplace_back([&] { help(surfaces, options, exchange); });
  SharedInMemory work(exchange, false);
  return run(surfaces, options, &work);
}

UnwrapOptions textures() {
  UnwrapOptions options;
  options.max_distortion = kDefaultDistortion;
  options.guarantee = Guarantee::bijective;
  return options;
}

TEST(SharedWork, GivesTheBytesAndEventsOfOneAlone) {
  const Surfaces surfaces = scene();
  const Told alone = run(surfaces, textures(), nullptr);
  for (const int helpers : {0, 1, 3}) {
    Exchange exchange;
    const Told together = run_with_helpers(surfaces, textures(), helpers, exchange);
    EXPECT_TRUE(together.answer == alone.answer) << helpers;
    EXPECT_EQ(together.events, alone.events) << helpers;
    EXPECT_GE(exchange.stages.size(), 2U);
  }
}

TEST(SharedWork, TakesWhatHelpersHaveMade) {
  const Surfaces surfaces = scene();
  UnwrapOptions curve = textures();
  curve.method = Method::hybrid;
  curve.lambda_curve = {0.01, 1, 0.1};
  for (const UnwrapOptions& options : {textures(), curve}) {
    Exchange exchange;
    help(surfaces, options, exchange);  // there was time for all of it
    SharedInMemory work(exchange, false);
    const Told together = run(surfaces, options, &work);
    EXPECT_TRUE(together.answer == run(surfaces, options, nullptr).answer);
    int bundles = 0;
    for (const auto& [key, stage] : exchange.stages)
      bundles += static_cast<int>(stage.bundles.size());
    EXPECT_GT(bundles, 4);
    EXPECT_EQ(exchange.found, bundles);
  }
}

TEST(SharedWork, TakesChartsThatWereSplit) {
  const Surfaces surfaces = overlapping_disks();
  UnwrapOptions options;
  options.guarantee = Guarantee::bijective;
  const Told alone = run(surfaces, options, nullptr);
  ASSERT_GT(alone.most_parts, 2);
  Exchange exchange;
  help(surfaces, options, exchange);
  SharedInMemory work(exchange, false);
  const Told together = run(surfaces, options, &work);
  EXPECT_TRUE(together.answer == alone.answer);
  EXPECT_EQ(together.events, alone.events);
  EXPECT_GT(exchange.found, 3);
}

TEST(SharedWork, MakesAgainWhatIsLostOrDamaged) {
  const Surfaces surfaces = scene();
  const std::string alone = run(surfaces, textures(), nullptr).answer;
  const auto lose_all = [](Exchange& exchange) {
    for (auto& [key, stage] : exchange.stages) stage.bundles.clear();
    exchange.waits_for_helpers = false;
  };
  const auto damage = [](auto change) {
    return [change](Exchange& exchange) {
      exchange.damage = [change](std::string bytes) {
        change(bytes);
        return bytes;
      };
    };
  };
  const std::vector<std::function<void(Exchange&)>> mishaps = {
      lose_all, damage([](std::string& bytes) { bytes[bytes.size() / 2] ^= 1; }),
      damage([](std::string& bytes) { bytes.resize(bytes.size() / 2); }),
      damage([](std::string& bytes) { bytes.clear(); }),
      [](Exchange& exchange) {  // sound, but of other things
        for (auto& [key, stage] : exchange.stages)
          for (auto& [number, bytes] : stage.bundles) bytes = stage.bundles.begin()->second;
      }};
  for (std::size_t k = 0; k < mishaps.size(); ++k) {
    Exchange exchange;
    help(surfaces, textures(), exchange);
    mishaps[k](exchange);
    SharedInMemory work(exchange, false);
    EXPECT_TRUE(run(surfaces, textures(), &work).answer == alone) << k;
  }
}

TEST(SharedWork, TakesNothingOfAJobThatDiffers) {
  const Surfaces surfaces = scene();
  Exchange exchange;
  help(surfaces, textures(), exchange);
  UnwrapOptions tighter = textures();
  tighter.max_distortion = 2.0173;
  Surfaces moved = surfaces;
  moved[0].mesh.positions[0].x() += 0.01;
  for (const auto& [other, options] :
       {std::pair{surfaces, tighter}, std::pair{moved, textures()}}) {
    SharedInMemory work(exchange, false);
    EXPECT_TRUE(run(other, options, &work).answer == run(other, options, nullptr).answer);
  }
  EXPECT_EQ(exchange.found, 0);
}

}  // namespace
}  // namespace unwrapd::server::work
