// What `seam_avoid` does with the options of `preset=texture`: the length of seams in the half of a
// mesh that is painted, and in all of it, before and after; area of the surface: 1.
//   unwrapd_painted [--value=V] FILE|FOLDER|noisy:FACES|made:FAMILY:FACES:SEED...
// V other than 1 shows another weight of painted seams: 1 + kAvoidance V.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/unwrap.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/named_meshes.hpp"

namespace unwrapd::bench {
namespace {

/// 1 for vertices beyond the median along the x axis.
std::vector<double> half_of(const TriMesh& mesh) {
  std::vector<double> x;
  for (const Vec3& p : mesh.positions) x.push_back(p.x());
  std::vector<double> sorted = x;
  std::ranges::nth_element(sorted, sorted.begin() + std::ssize(sorted) / 2);
  const double middle = sorted[sorted.size() / 2];
  for (double& value : x) value = value > middle ? 1 : 0;
  return x;
}

struct Seams {
  double all = 0, painted = 0;  ///< lengths; area of the surface: 1
};

/// By the UVs alone: edges whose two sides have different ones.
Seams seams_of(const Surface& surface, const UnwrappedSurface& unwrapped,
               const std::vector<double>& value) {
  std::map<std::array<Index, 2>, std::vector<std::array<Vec2, 2>>> sides;
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const Index a = surface.mesh.faces[t][i], b = surface.mesh.faces[t][j];
      const auto uv = [&](std::size_t k) {
        return unwrapped.uv[std::size_t(unwrapped.faces[t][k])];
      };
      const bool ascends = a < b;
      sides[{std::min(a, b), std::max(a, b)}].push_back({uv(ascends ? i : j), uv(ascends ? j : i)});
    }
  Seams seams;
  for (const auto& [ends, both] : sides) {
    if (both.size() != 2 || both[0] == both[1]) continue;
    const auto [a, b] = std::array{std::size_t(ends[0]), std::size_t(ends[1])};
    const double length = (surface.mesh.positions[a] - surface.mesh.positions[b]).norm();
    seams.all += length;
    seams.painted += length * (value[a] + value[b]) / 2;
  }
  return seams;
}

struct Result {
  Seams seams;
  Report report;
};

Result result_of(const std::vector<Surface>& surfaces, const std::vector<double>& half) {
  const UnwrapOptions options{.max_distortion = kDefaultDistortion,
                              .guarantee = Guarantee::bijective};
  SerialExecutor serial;
  Unwrapped unwrapped = unwrap(surfaces, options, {}, serial);
  Result result{seams_of(surfaces.front(), unwrapped.surfaces.front(), half),
                std::move(unwrapped.report)};
  const double unit = std::sqrt(result.report.area);
  result.seams.all /= unit;
  result.seams.painted /= unit;
  return result;
}

struct Shape {
  std::string name;
  std::vector<Surface> surfaces;
};

void show(Shape shape, double value, std::vector<double>& in_half, std::vector<double>& in_all) {
  const std::vector<double> half = half_of(shape.surfaces.front().mesh);
  const Result before = result_of(shape.surfaces, half);
  for (const double own : half) shape.surfaces.front().seam_avoid.push_back(value * own);
  const Result after = result_of(shape.surfaces, half);
  in_half.push_back(after.seams.painted / std::max(before.seams.painted, 1e-9));
  in_all.push_back(after.seams.all / std::max(before.seams.all, 1e-9));
  std::printf("%-22s %7zu %3zu %3zu %7.3f %7.3f %6.2f %7.3f %7.3f %6.2f %7.4f %7.4f %5.3f %5.3f\n",
              shape.name.c_str(), half.size(), before.report.charts.size(),
              after.report.charts.size(), before.seams.painted, after.seams.painted, in_half.back(),
              before.seams.all, after.seams.all, in_all.back(),
              std::max(before.report.distortion.angle, before.report.distortion.area),
              std::max(after.report.distortion.angle, after.report.distortion.area),
              before.report.fill, after.report.fill);
  std::fflush(stdout);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

int show_all(const std::vector<std::string>& paths, double value) {
  std::printf("%-22s %7s %7s %23s %22s %17s %11s\n", "", "", "charts", "seams in the half",
              "all seams", "distortion", "fill");
  std::vector<double> in_half, in_all;
  for (const std::string& path : paths)
    for (const std::filesystem::path& mesh : meshes_in(path))
      show({mesh.stem().string(), read_surfaces(mesh)}, value, in_half, in_all);
  std::printf("median of after / before: in the half %.3f, in all %.3f\n", median(in_half),
              median(in_all));
  return 0;
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  std::vector<std::string> paths(argv + 1, argv + argc);
  double value = 1;
  std::erase_if(paths, [&](const std::string& word) {
    if (!word.starts_with("--value=")) return false;
    value = std::atof(word.c_str() + 8);
    return true;
  });
  for (const std::string& path : paths)
    if (!unwrapd::bench::is_generated(path) && !std::filesystem::exists(path)) {
      std::fprintf(stderr, "unwrapd_painted: there is no %s\n", path.c_str());
      return 2;
    }
  return unwrapd::bench::show_all(paths, value);
}
