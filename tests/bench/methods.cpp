// Every method side by side, on one thread. Needs nothing but the core.
//   unwrapd_methods table1             the paper's Table 1, ours beside each of its figures
//   unwrapd_methods growth             time and memory of each method at 20k, 80k and 320k faces
//   unwrapd_methods one METHOD FACES   one run of the above, in a process of its own: its memory
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/charts/charts.hpp"
#include "core/measure/distortion.hpp"
#include "core/solve/solve.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/table1.hpp"
#include "tests/core/obj_reader.hpp"

namespace unwrapd::bench {
namespace {

solve::Solution solved(const solve::Disk& disk, const UnwrapOptions& options) {
  SerialExecutor serial;
  return solve::Solver(disk, options, {}, serial).run(options.lambda, {});
}

// --- Table 1 ------------------------------------------------------------------------------------

constexpr const char* kTableHead =
    "Table 1 of the paper, its figure beside ours; UV area scaled to 3D area (Sec. 6).\n"
    "CP* is CP as its authors probably ran it. Why a figure is off:\n"
    "  pins     D_area depends on which two vertices are pinned\n"
    "  angles   their programs weigh, start or draw angles in a way that is not published\n"
    "  circles  the radii from which IC starts are not published\n"
    "  mended   our CP keeps the shape of triangles that scaling breaks: see CP*\n"
    "  broken   rests on what lengths of no triangle are drawn as\n"
    "  unknown  no program gives the printed figure";

std::string figure(const std::optional<double>& value, int digits) {
  if (!value) return "-";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, *value);
  return text.data();
}

/// The paper's figure and ours; ours is missing where there is no map.
void print_pair(const std::optional<double>& paper, const std::optional<double>& ours) {
  std::printf("%10s %9s", figure(paper, 2).c_str(), figure(ours, 3).c_str());
}

void print_row(const solve::Disk& disk, const Model& model, const Column& column,
               const Printed& paper) {
  std::printf("  %-5s", column.name);
  const Stopwatch watch;
  try {
    const UvMap uv = map_of(disk, model, column);
    const double seconds = watch.seconds();
    const Distortion d = measure::distortion(measure::distortion_sums(disk.rest, disk.faces, uv));
    print_pair(paper.angle, d.angle), print_pair(paper.area, d.area);
    const bool is_as_printed = !is_off(paper.angle, d.angle) && !is_off(paper.area, d.area);
    std::printf(" %7d %9.3f  %s\n", d.flipped, seconds, is_as_printed ? "" : column.why);
  } catch (const Error& error) {
    print_pair(paper.angle, {}), print_pair(paper.area, {});
    std::printf("   no map: %s\n", error.what());
  }
}

int show_table1() {
  if (test_data().empty()) {
    std::fputs("the paper's models are not here (UNWRAPD_TEST_DATA)\n", stderr);
    return 1;
  }
  std::puts(kTableHead);
  for (std::size_t m = 0; m < kModels.size(); ++m) {
    const charts::Charts charts = charts::make_charts(
        shapes::surface_of(read_obj(test_data() / "paper" / kModels[m].file)), SeamMode::automatic);
    const charts::Chart& chart = charts.charts.at(0);
    const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops);
    std::printf("\n%s: %zu faces, boundaries: %zu\n", kModels[m].name, disk.faces.size(),
                disk.loops.size());
    std::puts(
        "          D_angle      ours    D_area      ours   flips   seconds  off by more than 0.02");
    for (const Column& column : kColumns)
      print_row(disk, kModels[m], column, column.printed.at(m)), std::fflush(stdout);
  }
  return 0;
}

// --- growth -------------------------------------------------------------------------------------

constexpr unsigned kPatienceSeconds = 60;
constexpr std::array<double, 3> kSizes{20e3, 80e3, 320e3};

struct Named {
  const char* name;
  Method method;
};

constexpr std::array<Named, 9> kMethods{{{"asap", Method::asap},
                                         {"arap", Method::arap},
                                         {"hybrid", Method::hybrid},
                                         {"abf", Method::abf},
                                         {"linabf", Method::linabf},
                                         {"cp", Method::cp},
                                         {"bff", Method::bff},
                                         {"ic", Method::ic},
                                         {"slim", Method::slim}}};

/// Prints seconds, the peak of memory and the memory before, MB; "error" where there is no map. The
/// alarm ends a process that takes too long.
int run_one(const char* name, double faces) {
  alarm(kPatienceSeconds + 5);
  for (const Named& named : kMethods) {
    if (std::strcmp(named.name, name) != 0) continue;
    const TriMesh mesh = surface(faces);
    const charts::Charts charts = charts::make_charts(shapes::surface_of(mesh), SeamMode::keep);
    const solve::Disk disk = solve::make_disk(charts.charts[0].mesh, charts.charts[0].loops);
    const double before = peak_megabytes();
    const Stopwatch watch;
    try {
      const solve::Solution s = solved(disk, {.method = named.method});
      std::printf("%.4f %.0f %.0f\n", watch.seconds(), peak_megabytes(), before);
      return s.uv.empty() ? 1 : 0;
    } catch (const Error& error) {
      std::fprintf(stderr, "%s: %s\n", name, error.what());
    }
  }
  return 1;
}

struct Sample {
  double faces = 0, seconds = 0, megabytes = 0, before = 0;
};

std::optional<Sample> measured(const std::string& self, const char* name, double faces) {
  const std::string command =
      self + " one " + name + " " + std::to_string(static_cast<long>(faces));
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  Sample sample{.faces = faces};
  const int read =
      std::fscanf(pipe, "%lf %lf %lf", &sample.seconds, &sample.megabytes, &sample.before);
  const int status = pclose(pipe);
  if (read != 3 || status != 0) return std::nullopt;
  return sample;
}

/// Time grows as faces^exponent from the first sample to the last.
double exponent(std::span<const Sample> samples) {
  return std::log(samples.back().seconds / samples.front().seconds) /
         std::log(samples.back().faces / samples.front().faces);
}

/// What the next size would take, going by what is known.
double expected_seconds(std::span<const Sample> samples, double faces) {
  if (samples.empty()) return 0;
  const double growth = samples.size() > 1 ? exponent(samples) : 1.2;
  return samples.back().seconds * std::pow(faces / samples.back().faces, growth);
}

void show_method(const std::string& self, const char* name) {
  std::printf("%-7s", name);
  std::vector<Sample> samples;
  for (double faces : kSizes) {
    if (expected_seconds(samples, faces) > kPatienceSeconds) break;
    const auto sample = measured(self, name, faces);
    if (!sample) break;
    samples.push_back(*sample);
    std::printf("%10.3f s %5.0f MB", sample->seconds, sample->megabytes - sample->before);
    std::fflush(stdout);
  }
  for (std::size_t k = samples.size(); k < kSizes.size(); ++k) std::printf("%21s", "skipped");
  if (samples.size() > 1) std::printf("   faces^%.2f", exponent(samples));
  std::puts(samples.size() < kSizes.size() ? "   (more than a minute, or no map)" : "");
}

int show_growth(const std::string& self) {
  std::puts("Time, and memory above the mesh's own, of each method with its default options");
  std::printf("%-7s%15.0f faces%15.0f faces%15.0f faces   growth\n", "", kSizes[0], kSizes[1],
              kSizes[2]);
  for (const Named& named : kMethods) show_method(self, named.name);
  return 0;
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "table1") return unwrapd::bench::show_table1();
  if (command == "growth") return unwrapd::bench::show_growth(argv[0]);
  if (command == "one" && argc == 4)
    return unwrapd::bench::run_one(argv[2], std::strtod(argv[3], nullptr));
  std::fputs("usage: unwrapd_methods table1 | growth | one METHOD FACES\n", stderr);
  return 2;
}
