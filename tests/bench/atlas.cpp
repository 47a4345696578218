// The atlas of each mesh in a table, measured on what is written, beside what others make of those
// that are well known.
//   unwrapd_atlas [--default] [--fast|--best] FILE|FOLDER|noisy:FACES|made:FAMILY:FACES:SEED...
//   .obj, .glb, .gltf, a generated body like a scan, or a shape of a family (made_shapes.hpp);
//   --default: disks stay one chart
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/pipeline/as_mapped.hpp"
#include "core/unwrap.hpp"
#include "tests/bench/creases.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/named_meshes.hpp"
#include "tests/bench/peers.hpp"
#include "tests/bench/written_atlas.hpp"

namespace unwrapd::bench {
namespace {

namespace fs = std::filesystem;

/// Ours in shares of theirs, of all meshes.
struct Shares {
  const char* peer;
  std::vector<double> charts, seams;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

void print_peer(const PeerFigures& peer, const WrittenAtlas& own, double seam, Shares& shares) {
  if (peer.charts == 0) return;
  shares.charts.push_back(double(own.charts) / peer.charts);
  shares.seams.push_back(seam / peer.seam);
  std::printf(" | %s %d/%.4g/%.3f %.3gs: charts x%.2f seam x%.2f", shares.peer, peer.charts,
              peer.seam, peer.fill, peer.seconds, shares.charts.back(), shares.seams.back());
}

/// What running a job took.
struct Took {
  double seconds = 0, megabytes = 0;
};

/// D_angle or D_area of the chart that has most.
double worst_chart(const Report& report) {
  double worst = 2;
  for (const ChartReport& chart : report.charts)
    worst = std::max({worst, chart.distortion.angle, chart.distortion.area});
  return worst;
}

void print_row(const fs::path& path, const Unwrapped& unwrapped, const WrittenAtlas& own,
               double creases, const Took& took, std::span<Shares> shares) {
  const Report& report = unwrapped.report;
  std::printf(
      "%-22.22s %7d %6d %7.3f %7.4f %7.4f %5.3f %5d %7lld %6.2f %8d %6.2f %7.2f %6.0f %7.3f",
      path.stem().string().c_str(), report.input.faces, own.charts, report.seam_ratio, own.angle,
      own.area, own.fill, own.flips, static_cast<long long>(own.overlapping_texels), own.gap,
      own.mirrored, creases, took.seconds, took.megabytes, worst_chart(report));
  const auto peers = std::ranges::find(kPeers, path.stem().string(), &PeerRow::mesh);
  if (peers != kPeers.end()) {
    print_peer(peers->xatlas, own, report.seam_ratio, shares[0]);
    print_peer(peers->uvatlas, own, report.seam_ratio, shares[1]);
    print_peer(peers->uvatlas_held, own, report.seam_ratio, shares[2]);
  }
  std::puts("");
}

void show(const fs::path& path, const UnwrapOptions& options, std::span<Shares> shares) try {
  const std::vector<Surface> surfaces = read_surfaces(path);
  SerialExecutor serial;
  std::ofstream("/proc/self/clear_refs") << '5';  // the peak of memory begins anew
  const double begin = processor_seconds();
  const Unwrapped unwrapped = unwrap(surfaces, options, {}, serial);
  const double seconds = processor_seconds() - begin, megabytes = peak_megabytes();
  std::vector<UnwrappedSurface> maps = unwrapped.surfaces;
  const charts::RepairedSurfaces repaired = pipeline::as_mapped(surfaces, options, maps);
  const std::vector<WrittenFace> faces = written_faces(repaired.surfaces, maps);
  const WrittenRules rules{.resolution = options.resolution, .most_gap = 2.0 * options.padding};
  print_row(path, unwrapped, measure_written(faces, rules),
            share_on_creases(surfaces, unwrapped.surfaces), {seconds, megabytes}, shares);
} catch (const Error& e) {
  std::printf("%-22.22s refused: %s\n", path.stem().string().c_str(), e.what());
}

int show_all(const std::vector<std::string>& paths, const UnwrapOptions& options) {
  std::printf(
      "D <= 2.02, %d texels, padding %d; CPU seconds of one thread. xatlas, UVAtlas: charts/"
      "seam/fill and seconds as\nmeasured once elsewhere, not run here; then ours in shares "
      "of theirs. MB: the peak meanwhile. gap: texels, at least. overlap: texels of 4096. crease: "
      "share of the seams that lies on sharp or split edges and "
      "between materials.\n",
      options.resolution, options.padding);
  std::printf("%-22s %7s %6s %7s %7s %7s %5s %5s %7s %6s %8s %6s %7s %6s %7s\n", "mesh", "faces",
              "charts", "seam", "D_angle", "D_area", "fill", "flips", "overlap", "gap", "mirrored",
              "crease", "seconds", "MB", "worst D");
  std::array<Shares, 3> shares = {
      Shares{"xatlas", {}, {}}, {"UVAtlas", {}, {}}, {"UVAtlas at D 2.02", {}, {}}};
  for (const std::string& path : paths)
    for (const fs::path& mesh : meshes_in(path)) {
      show(mesh, options, shares);
      std::fflush(stdout);
    }
  for (const Shares& own : shares)
    if (!own.charts.empty())
      std::printf("median of %zu, ours in shares of %s: charts %.3f, seam %.3f\n",
                  own.charts.size(), own.peer, median(own.charts), median(own.seams));
  return 0;
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  std::vector<std::string> paths(argv + 1, argv + argc);
  unwrapd::UnwrapOptions options{.max_distortion = unwrapd::kDefaultDistortion};
  if (std::erase(paths, "--default") > 0) options.max_distortion.reset();
  if (std::erase(paths, "--fast") > 0) options.effort = unwrapd::Effort::fast;
  if (std::erase(paths, "--best") > 0) options.effort = unwrapd::Effort::best;
  for (const std::string& path : paths)
    if (!unwrapd::bench::is_generated(path) && !std::filesystem::exists(path)) {
      std::fprintf(stderr, "unwrapd_atlas: there is no %s\n", path.c_str());
      return 2;
    }
  return unwrapd::bench::show_all(paths, options);
}
