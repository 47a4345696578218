// Times and memory of the core, as ratios within one run: machines are noisy, ratios less so.
//   unwrapd_bench            the table: ours against CGAL, growth, memory
//   unwrapd_bench --memory N the peak resident set of one ARAP call on N faces (one process each)
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/unwrap.hpp"
#include "tests/bench/cgal_arap.hpp"
#include "tests/bench/measure.hpp"
#include "tests/core/obj_reader.hpp"

namespace unwrapd::bench {
namespace {

constexpr int kRuns = 5;

double seconds_of(const std::vector<Surface>& surfaces, const UnwrapOptions& options) {
  SerialExecutor serial;
  const Stopwatch watch;
  const Unwrapped unwrapped = unwrap(surfaces, options, {}, serial);
  const double seconds = watch.seconds();
  if (unwrapped.surfaces.empty()) std::abort();  // keeps the result alive
  return seconds;
}

double median_seconds(const TriMesh& mesh, const UnwrapOptions& options) {
  const std::vector<Surface> surfaces{shapes::surface_of(mesh)};
  std::array<double, kRuns> seconds;
  for (double& s : seconds) s = seconds_of(surfaces, options);
  std::sort(seconds.begin(), seconds.end());
  return seconds[kRuns / 2];
}

TriMesh subdivided_to(TriMesh mesh, std::size_t faces) {
  while (mesh.faces.size() < faces) mesh = shapes::subdivided(mesh);
  return mesh;
}

void compare_with_cgal() {
  if (test_data().empty()) {
    std::puts("CGAL comparison skipped: the paper's models are not here (UNWRAPD_TEST_DATA)");
    return;
  }
  const UnwrapOptions options{.initial = InitialMap::mean_value};
  std::puts("ARAP, 10 iterations from a mean-value map, whole call      ours s   CGAL s    ratio");
  for (const auto& [name, file] : {std::pair{"Isis", "Isis_dABF.obj"}, {"Balls", "Balls.obj"}}) {
    const TriMesh mesh = subdivided_to(read_obj(test_data() / "paper" / file), 50'000);
    UvMap uv;
    const auto cgal = cgal_arap_seconds(mesh, uv);
    const double ours = median_seconds(mesh, options);
    std::printf("%-6s subdivided, %7zu faces %35.3f %8s %8.1f\n", name, mesh.faces.size(), ours,
                cgal ? std::to_string(*cgal).substr(0, 6).c_str() : "error",
                cgal ? *cgal / ours : 0.0);
  }
}

void show_growth() {
  std::puts("\nGrowth of one ARAP call (default options)   seconds   us/face");
  for (double faces : {20e3, 80e3, 320e3}) {
    const TriMesh mesh = sheet(faces);
    const double s = median_seconds(mesh, {});
    std::printf("%10zu faces %37.3f %9.2f\n", mesh.faces.size(), s,
                1e6 * s / static_cast<double>(mesh.faces.size()));
  }
}

int show_memory(double faces) {
  const std::vector<Surface> surfaces{shapes::surface_of(sheet(faces))};
  const double before = peak_megabytes();
  const double s = seconds_of(surfaces, {});
  std::printf("%10zu faces: peak %.0f MB (mesh alone %.0f MB), %.1f s\n",
              surfaces[0].mesh.faces.size(), peak_megabytes(), before, s);
  return 0;
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--memory") == 0)
    return unwrapd::bench::show_memory(std::strtod(argv[2], nullptr));
  unwrapd::bench::compare_with_cgal();
  unwrapd::bench::show_growth();
  std::puts("");
  std::fflush(stdout);
  const std::string self = argv[0];
  return std::system((self + " --memory 1e6").c_str()) == 0 ? 0 : 1;
}
