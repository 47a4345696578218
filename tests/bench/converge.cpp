// How ARAP's energy gets down, and from where: the figures of docs/adr/0004 and 0010.
//   unwrapd_converge            both tables, on the paper's models, once subdivided, and on other
//                               disks, some of them closed surfaces cut open
//   unwrapd_converge starts     the starts only
//   unwrapd_converge FILE.obj   both for one mesh
#include <Eigen/Dense>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/charts/charts.hpp"
#include "core/solve/solve.hpp"
#include "tests/bench/measure.hpp"
#include "tests/core/counting_executor.hpp"
#include "tests/core/obj_reader.hpp"

namespace unwrapd::bench {
namespace {

constexpr int kMost = 2000;
constexpr std::uintmax_t kLeastBytes = 5000;  // of a file: a mesh of a few faces is no measure
using Vectors = std::deque<std::vector<Vec2>>;

double dot(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v) sum += a[v].dot(b[v]);
  return sum;
}

/// a + weight b
std::vector<Vec2> sum(const std::vector<Vec2>& a, double weight, const std::vector<Vec2>& b) {
  std::vector<Vec2> c(a);
  for (std::size_t v = 0; v < c.size(); ++v) c[v] += weight * b[v];
  return c;
}

struct Problem {
  const solve::arap::Assembly& assembly;
  solve::arap::Objective& objective;
};

/// Plain iterations from extrapolated points; the extrapolation starts anew when the energy rises
/// (O'Donoghue, Candes 2015). Two evaluations an iteration: at the point and at the step's end.
std::vector<double> nesterov(const Problem& p, UvMap uv) {
  UvMap ahead = uv;
  std::vector<Vec2> force(uv.size());
  std::vector<double> energy{p.objective.evaluate(uv, force)};
  double theta = 1;
  for (int k = 0; k < kMost; ++k) {
    p.objective.evaluate(ahead, force);
    p.assembly.global.solve_by_rank(force);
    UvMap next = sum(ahead, 1, force);
    const double now = p.objective.evaluate(next, force);
    if (now > energy.back()) {
      theta = 1, ahead = uv;
      energy.push_back(energy.back());
      continue;
    }
    const double later = (1 + std::sqrt(1 + 4 * theta * theta)) / 2;
    ahead = sum(next, (theta - 1) / later, sum(next, -1, uv));
    theta = later, uv = std::move(next);
    energy.push_back(now);
  }
  return energy;
}

/// The plain iteration as a fixed point, depth 5 (Peng et al. 2018); the plain step where the
/// energy would rise.
std::vector<double> anderson(const Problem& p, UvMap uv) {
  std::vector<Vec2> force(uv.size()), old_step, old_end;
  std::vector<double> energy{p.objective.evaluate(uv, force)};
  Vectors steps, ends;
  for (int k = 0; k < kMost; ++k) {
    p.assembly.global.solve_by_rank(force);
    const UvMap end = sum(uv, 1, force);
    if (k > 0) steps.push_back(sum(force, -1, old_step)), ends.push_back(sum(end, -1, old_end));
    if (steps.size() > 5) steps.pop_front(), ends.pop_front();
    old_step = force, old_end = end;
    const auto m = static_cast<Eigen::Index>(steps.size());
    Eigen::MatrixXd gram(m, m);
    Eigen::VectorXd rhs(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const auto& own = steps[static_cast<std::size_t>(i)];
      rhs[i] = dot(own, force);
      for (Eigen::Index j = 0; j < m; ++j)
        gram(i, j) = (1 + (i == j) * 1e-12) * dot(own, steps[static_cast<std::size_t>(j)]);
    }
    const Eigen::VectorXd weight = gram.ldlt().solve(rhs);
    uv = end;
    for (Eigen::Index i = 0; i < m; ++i)
      uv = sum(uv, -weight[i], ends[static_cast<std::size_t>(i)]);
    double now = p.objective.evaluate(uv, force);
    if (!(now < energy.back())) now = p.objective.evaluate(uv = end, force);
    energy.push_back(now);
  }
  return energy;
}

int first_below(const std::vector<double>& energy, double bound) {
  const auto at = std::find_if(energy.begin(), energy.end(), [&](double e) { return e <= bound; });
  return at == energy.end() ? -1 : static_cast<int>(at - energy.begin());
}

/// Iterations from a mean-value map to 1e-3 and to 1e-5 above the lowest energy; -1: not in 2,000.
void compare_iterations(const solve::Disk& disk) {
  SerialExecutor serial;
  const solve::VertexConstraints free;
  const solve::arap::GlobalStep global(disk, free);
  const solve::arap::Assembly assembly{disk, free, global};
  solve::arap::Objective objective(disk, {}, free, global.rank(), serial);
  const UvMap start = solve::initial_map(disk, InitialMap::mean_value, global);
  solve::arap::Descent descent(assembly, start, {}, serial);
  solve::arap::run(descent, {1e-12, kMost}, {});
  const double least = descent.energy();
  const auto row = [&](const char* name, const std::vector<double>& energy) {
    std::printf("    %-9s %5d %5d\n", name, first_below(energy, least * 1.001),
                first_below(energy, least * 1.00001));
  };
  row("plain", solve::arap::local_global(assembly, start, {{}, kMost}, {}, serial).energy);
  const UvMap sorted = solve::arap::by_rank(start, global.rank());
  row("Anderson", anderson({assembly, objective}, sorted));
  row("Nesterov", nesterov({assembly, objective}, sorted));
  row("L-BFGS", descent.solution().energy);
}

/// What one job took: processor time, the least of a few runs, and how often the executor was asked
/// to sweep over the mesh, the same few times every iteration: that does not depend on the machine.
struct Cost {
  double seconds = 1e300;
  int sweeps = 0;
};

Cost run_from(const solve::Disk& disk, InitialMap start, solve::Solution& solution) {
  const UnwrapOptions options{.initial = start};
  Cost cost;
  for (double spent = 0; spent < 0.5;) {
    CountingExecutor executor;
    const double before = processor_seconds();
    solution = solve::Solver(disk, options, {}, executor).run(0, {});
    const double took = processor_seconds() - before;
    cost = {std::min(cost.seconds, took), executor.sweeps};
    spent += std::max(took, 0.01);
  }
  return cost;
}

/// Over all meshes.
struct Tally {
  int meshes = 0, low = 0;
  std::vector<double> time, work;

  static double median(std::vector<double> of) {
    std::sort(of.begin(), of.end());
    return of[of.size() / 2];
  }

  void print() const {
    if (meshes == 0) return;
    std::printf(
        "auto ends within 0.1 %% of the best start on %d of %d; against the mean of one start: "
        "time "
        "%.2f, at most %.2f; sweeps %.2f, at most %.2f\n",
        low, meshes, median(time), *std::max_element(time.begin(), time.end()), median(work),
        *std::max_element(work.begin(), work.end()));
  }
};

/// Against the mean of the starts that can be named.
void compare_starts(const solve::Disk& disk, Tally& tally) {
  double least = 1e300, seconds = 0, sweeps = 0;
  for (const auto& [name, start] : {std::pair{"mean_value", InitialMap::mean_value},
                                    {"tutte", InitialMap::tutte},
                                    {"lscm", InitialMap::lscm}}) {
    solve::Solution s;
    const Cost cost = run_from(disk, start, s);
    seconds += cost.seconds / 3, sweeps += cost.sweeps / 3.0;
    least = std::min(least, s.energy.back());
    std::printf("    %-10s energy %.6g  iterations %4d\n", name, s.energy.back(), s.iterations);
  }
  solve::Solution s;
  const Cost cost = run_from(disk, InitialMap::automatic, s);
  const double energy = s.energy.back();
  std::printf(
      "    %-10s energy %.6g  iterations %4d  above the best %+.3f %%  time %.2f  sweeps "
      "%.2f\n",
      "auto", energy, s.iterations, least > 1e-12 ? 100 * (energy / least - 1) : 0,
      cost.seconds / seconds, cost.sweeps / sweeps);
  ++tally.meshes, tally.low += energy <= least * 1.001 + 1e-8;
  tally.time.push_back(cost.seconds / seconds), tally.work.push_back(cost.sweeps / sweeps);
}

struct Tables {
  bool iterations = true;
  Tally starts;
};

void compare(const std::string& name, const TriMesh& mesh, Tables& tables) try {
  const charts::Charts charts = charts::make_charts(shapes::surface_of(mesh), SeamMode::keep);
  const charts::Chart& chart = charts.charts.front();
  const solve::Disk disk = solve::make_disk(chart.mesh, chart.loops);
  std::printf("%s: %zu faces, %zu boundaries\n", name.c_str(), disk.faces.size(),
              disk.loops.size());
  if (tables.iterations) compare_iterations(disk);
  compare_starts(disk, tables.starts);
  std::fflush(stdout);
} catch (const Error& e) {
  std::printf("%s: %s\n", name.c_str(), e.what());
}

void compare_all(Tables& tables) {
  for (const std::string folder : {"paper", "disk", "closed"}) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(test_data() / folder))
      if (entry.file_size() > kLeastBytes) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
      compare(file.stem().string(), read_obj(file), tables);
      if (folder == "paper")
        compare(file.stem().string() + ", subdivided", shapes::subdivided(read_obj(file)), tables);
    }
  }
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  const std::string argument = argc > 1 ? argv[1] : "";
  unwrapd::bench::Tables tables{argument != "starts", {}};
  if (argument.empty() || argument == "starts")
    unwrapd::bench::compare_all(tables);
  else
    unwrapd::bench::compare(argument, unwrapd::read_obj(argument), tables);
  tables.starts.print();
}
