// What `guarantee=bijective` costs beside `flip_free` with the options of `preset=chart`: processor
// time of unwrap(), without reading and writing, in pairs of runs; and the energy of the maps.
//   unwrapd_bijective [--pairs=N] FILE|FOLDER|noisy:FACES|made:FAMILY:FACES:SEED...
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/named_meshes.hpp"

namespace unwrapd::bench {
namespace {

constexpr double kMostMedian = 1.15, kMostWorst = 3;         // asked of the time
constexpr double kMostMedianRise = 0.5, kMostWorstRise = 5;  // asked of the energy, per cent

struct Row {
  double flip_free = 0, bijective = 0;  ///< seconds, the median of all pairs
  double rise = 0;                      ///< of energy, per cent; the greatest of all charts
  Index cut = 0;                        ///< charts that were split
  Report before, after;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// Seconds of one call; its report goes to `report`.
double timed(const std::vector<Surface>& surfaces, UnwrapOptions options, Guarantee guarantee,
             Report& report) {
  options.guarantee = guarantee;
  SerialExecutor serial;
  const double begin = thread_seconds();
  report = unwrap(surfaces, options, {}, serial).report;
  return thread_seconds() - begin;
}

Row measured(const std::vector<Surface>& surfaces, const UnwrapOptions& options, int pairs) {
  Row row;
  std::vector<double> flip_free, bijective;
  for (int k = 0; k < pairs; ++k) {
    flip_free.push_back(timed(surfaces, options, Guarantee::flip_free, row.before));
    bijective.push_back(timed(surfaces, options, Guarantee::bijective, row.after));
  }
  row.flip_free = median(flip_free);
  row.bijective = median(bijective);
  for (const ChartReport& chart : row.after.charts) {
    row.rise = std::max(row.rise, 100 * chart.mending.energy_rise);
    row.cut += chart.mending.parts > 1 ? 1 : 0;
  }
  return row;
}

void print(const std::filesystem::path& path, const Row& row) {
  std::printf("%-26.26s %7d %7zu %8.3f %8.3f %7.2f %8.2f %6zu %4d %8.4f %8.4f %6.3f\n",
              path.stem().string().c_str(), row.before.input.faces,
              static_cast<std::size_t>(row.before.overlaps.value_or(0)), row.flip_free,
              row.bijective, row.bijective / row.flip_free, row.rise, row.after.charts.size(),
              row.cut, row.after.distortion.angle, row.after.distortion.area, row.after.fill);
  std::fflush(stdout);
}

int show_all(const std::vector<std::string>& paths, const UnwrapOptions& options, int pairs) {
  std::printf("%-26s %7s %7s %8s %8s %7s %8s %6s %4s %8s %8s %6s\n", "mesh", "faces", "overlap",
              "flipfree", "biject", "ratio", "rise, %", "charts", "cut", "D_angle", "D_area",
              "fill");
  std::vector<double> ratios, rises, ratios_of_overlaps;
  for (const std::string& path : paths)
    for (const std::filesystem::path& mesh : meshes_in(path)) try {
        const Row row = measured(read_surfaces(mesh), options, pairs);
        ratios.push_back(row.bijective / row.flip_free);
        rises.push_back(row.rise);
        if (row.before.overlaps.value_or(0) > 0) ratios_of_overlaps.push_back(ratios.back());
        print(mesh, row);
      } catch (const Error& e) {
        std::printf("%-26.26s refused: %s\n", mesh.stem().string().c_str(), e.what());
      }
  if (ratios.empty()) return 0;
  std::printf("time: median %.3f (asked: %.2f), worst %.2f (asked: %.0f)\n", median(ratios),
              kMostMedian, *std::ranges::max_element(ratios), kMostWorst);
  std::printf("time where the map of flip_free overlaps: median %.3f of %zu\n",
              median(ratios_of_overlaps), ratios_of_overlaps.size());
  std::printf("rise: median %.3f %% (asked: %.1f), worst %.2f %% (asked: %.0f)\n", median(rises),
              kMostMedianRise, *std::ranges::max_element(rises), kMostWorstRise);
  return 0;
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  std::vector<std::string> paths(argv + 1, argv + argc);
  int pairs = 3;
  std::erase_if(paths, [&](const std::string& word) {
    if (!word.starts_with("--pairs=")) return false;
    pairs = std::max(1, std::atoi(word.c_str() + 8));
    return true;
  });
  for (const std::string& path : paths)
    if (!unwrapd::bench::is_generated(path) && !std::filesystem::exists(path)) {
      std::fprintf(stderr, "unwrapd_bijective: there is no %s\n", path.c_str());
      return 2;
    }
  return unwrapd::bench::show_all(paths, {}, pairs);
}
