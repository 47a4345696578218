// The goals of speed and memory, as ratios within one run: machines are noisy, ratios less so.
// Times are the processor's, the least of several runs; those of two threads what remains when the
// blocks of every loop are dealt to two (DealtToTwo), but for one row by the clock.
//   unwrapd_bench [OUT.json [--tiny]]   the table: ours against CGAL, Eigen and CHOLMOD, and
//   against ourselves; --tiny: on meshes of a hundredth of the faces, to see whether it runs
//   unwrapd_bench --large      the same for 4M faces, which takes minutes: memory alone
//   unwrapd_bench --memory N   peak and seconds of one ARAP call on N faces (a process each)
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "core/solve/solve.hpp"
#include "core/unwrap.hpp"
#include "server/work/solver_cache.hpp"
#include "server/work/thread_executor.hpp"
#include "tests/bench/cgal_arap.hpp"
#include "tests/bench/goals.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/rivals.hpp"
#include "tests/core/linear/systems.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::bench {
namespace {

constexpr int kRuns = 3;
const UnwrapOptions kTenIterations{.stop = {.iterations = 10}};

double wall_seconds() {
  static const Stopwatch since_start;
  return since_start.seconds();
}
using Clock = double (*)();

/// The least of some calls.
double seconds_of(Clock now, const std::function<void()>& call, int runs = kRuns) {
  double least = 1e300;
  for (int k = 0; k < runs; ++k) {
    const double start = now();
    call();
    least = std::min(least, now() - start);
  }
  return least;
}

/// The least of some calls that two threads share.
double seconds_of_two(const std::function<void(Executor&)>& call) {
  double least = 1e300;
  for (int k = 0; k < kRuns; ++k) {
    DealtToTwo two;
    const double start = thread_seconds();
    call(two);
    least = std::min(least, thread_seconds() - start - two.saved());
  }
  return least;
}

void unwrap_once(const TriMesh& mesh, const UnwrapOptions& options, Executor& executor) {
  const std::vector<Surface> surfaces{shapes::surface_of(mesh)};
  if (unwrap(surfaces, options, {}, executor).surfaces.empty()) std::abort();
}

TriMesh subdivided_to(TriMesh mesh, std::size_t faces) {
  while (mesh.faces.size() < faces) mesh = shapes::subdivided(mesh);
  return mesh;
}

void compare_with_cgal(Goals& goals, const std::string& name, const char* file) {
  const TriMesh mesh = subdivided_to(read_obj(test_data() / "paper" / file), 50'000);
  UvMap uv;
  const auto cgal = cgal_arap_seconds(mesh, uv);
  if (!cgal) return;
  UnwrapOptions options = kTenIterations;
  const auto ours = [&](InitialMap start) {
    options.initial = start;
    return seconds_of_two([&](Executor& two) { unwrap_once(mesh, options, two); });
  };
  const std::string title = name + " subdivided, whole call, 2 threads, times as fast as CGAL: ";
  goals.at_least(title + "same start", 150, *cgal / ours(InitialMap::mean_value));
  goals.at_least(title + "ours", 150, *cgal / ours(InitialMap::automatic));
}

void compare_engines(Goals& goals, double faces, const std::string& title) {
  const shapes::OwnedDisk owned = shapes::disk_of(surface(faces));
  const linear::SparseMatrix matrix = linear::arap_matrix(owned.disk);
  std::vector<Vec2> b(owned.disk.positions.size(), Vec2(1, -1));
  const double ours = seconds_of_two([&](Executor& two) {
    const auto factor = linear::try_factor(linear::analyse(matrix), matrix, two);
    for (int k = 0; k < 10; ++k) factor->solve(b, two);
  });
  goals.at_least(title + ", engine, 2 threads, times as fast as Eigen's", 6,
                 1e-3 * time_eigen(matrix, Unknowns::single).ten_iterations() / ours);
  if (const auto cholmod = time_cholmod(matrix, Unknowns::single))
    goals.at_least(title + ", engine, 2 threads, as CHOLMOD", 3,
                   1e-3 * cholmod->ten_iterations() / ours);
}

/// Seconds of jobs on one mesh that share a cache, one after the other.
struct SecondJobs {
  double first = 1e300, again = 1e300, bypass_cache = 1e300, other = 1e300, direct = 1e300,
         moved = 1e300;

  void run(const TriMesh& mesh) {
    UnwrapOptions nine = kTenIterations, hybrid = kTenIterations, asap = kTenIterations;
    nine.stop.iterations = 9;  // of ten the map is known
    hybrid.method = Method::hybrid, hybrid.lambda = 1, asap.method = Method::asap;
    TriMesh changed = mesh;
    for (Vec3& p : changed.positions) p.z() *= 1.1;
    server::work::SolverCache cache({std::int64_t{1} << 30, std::int64_t{1} << 34}, 1);
    server::work::ThreadExecutor one(1, &cache);
    const auto least = [&](double& seconds, const TriMesh& given, const UnwrapOptions& options) {
      const auto job = [&] { unwrap_once(given, options, one); };
      seconds = std::min(seconds, seconds_of(processor_seconds, job, 1));
    };
    least(first, mesh, kTenIterations);
    least(again, mesh, kTenIterations);
    least(bypass_cache, mesh, nine);
    least(other, mesh, hybrid);
    unwrap_once(mesh, asap, one);
    least(direct, mesh, asap);
    least(moved, changed, kTenIterations);
  }
};

void show_second_jobs(Goals& goals, const TriMesh& mesh) {
  SecondJobs took;
  for (int k = 0; k < kRuns; ++k) took.run(mesh);
  goals.at_most("100k faces: the same job again, share of the first's time", .25,
                took.again / took.first);
  goals.at_most("100k faces: again, nine iterations made anew", .25,
                took.bypass_cache / took.first);
  goals.at_most("100k faces: again with another lambda", .25, took.other / took.first);
  goals.at_most("100k faces: ASAP again", .25, took.direct / took.first);
  goals.at_most("100k faces: other positions, known connectivity", .55, took.moved / took.first);
}

void show_iteration(Goals& goals, const TriMesh& mesh, const std::string& title) {
  const shapes::OwnedDisk owned = shapes::disk_of(mesh);
  const solve::VertexConstraints nothing;
  SerialExecutor serial;
  const solve::arap::GlobalStep global(owned.disk, nothing, &serial);
  const auto panels =
      static_cast<double>(linear::analyse(linear::arap_matrix(owned.disk))->panel_bytes());
  const UvMap start = solve::initial_map(owned.disk, InitialMap::automatic, global);
  const auto run = [&](int iterations) {
    return seconds_of(processor_seconds, [&] {
      solve::arap::local_global({owned.disk, nothing, global}, start, {{}, iterations}, {}, serial);
    });
  };
  const double iteration = (run(30) - run(10)) / 20;
  const double reading = 2 * panels / (1e9 * read_bandwidth(processor_seconds));
  goals.at_most(title + ": one iteration, times reading the panels twice", 1.5,
                iteration / reading);
}

/// Seconds until a solver's energy has come down to a bound; infinity where it never does.
struct Descended {
  double lowest = 0;
  std::vector<std::pair<double, double>> trail;  // seconds, energy

  [[nodiscard]] double seconds_to(double bound) const {
    for (const auto& [seconds, energy] : trail)
      if (energy <= bound) return seconds;
    return std::numeric_limits<double>::infinity();
  }
};

Descended descend(const solve::Disk& disk, const Stop& stop) {
  SerialExecutor serial;
  const UnwrapOptions options{.stop = stop};
  solve::Solver solver(disk, options, {}, serial);
  Descended descended;
  const double start = processor_seconds();
  solve::SolveWatch watch;
  watch.loop.on_iteration = [&](const solve::Solution& s) {
    descended.trail.emplace_back(processor_seconds() - start, s.energy.back());
  };
  descended.lowest = solver.run(0, watch).energy.back();
  return descended;
}

void show_convergence(Goals& goals, const TriMesh& mesh, const std::string& title) {
  const shapes::OwnedDisk owned = shapes::disk_of(mesh);
  const Descended fast = descend(owned.disk, {.tolerance = 1e-9, .max_iterations = 3000});
  const Descended plain = descend(owned.disk, {.iterations = 3000});
  const double bound = (1 + 1e-4) * std::min(fast.lowest, plain.lowest);
  const double seconds = std::min(plain.seconds_to(bound), plain.trail.back().first);
  goals.at_least(title + ": to 1e-4 of the lowest energy, times as fast as plain", 10,
                 seconds / fast.seconds_to(bound));
}

void show_threads(Goals& goals, const TriMesh& mesh) {
  server::work::ThreadExecutor one(1), two(2);
  const auto seconds = [&](Executor& executor) {
    return seconds_of(wall_seconds, [&] { unwrap_once(mesh, kTenIterations, executor); });
  };
  const double alone = seconds(one);
  goals.at_least("320k faces, whole call, by the clock: two threads against one", 1.4,
                 alone / seconds(two));
  const auto whole = [&](Executor& both) { unwrap_once(mesh, kTenIterations, both); };
  const double processor = seconds_of(processor_seconds, [&] { whole(one); });
  goals.at_least("320k faces, whole call, blocks dealt to two: against one thread", 1.4,
                 processor / seconds_of_two(whole));
}

void show_growth(Goals& goals, double share) {
  SerialExecutor serial;
  const auto seconds = [&](double faces) {
    const TriMesh mesh = surface(faces);
    return seconds_of(
        processor_seconds, [&] { unwrap_once(mesh, kTenIterations, serial); }, 2);
  };
  goals.at_most("growth of the whole call, 20k to 1.3M faces: exponent", 1.15,
                std::log(seconds(share * 1.28e6) / seconds(share * 2e4)) / std::log(64.0));
}

int show_memory(double faces) {
  const TriMesh mesh = surface(faces);
  server::work::SolverCache cache({}, 1);  // what is kept counts
  server::work::ThreadExecutor one(1, &cache);
  const double s = seconds_of(
      processor_seconds, [&] { unwrap_once(mesh, kTenIterations, one); }, 1);
  std::printf("%.0f %.1f\n", peak_megabytes(), s);
  return 0;
}

/// In a process of its own.
void show_memory(Goals& goals, const std::string& self, const char* faces, double asked) {
  std::FILE* run = popen((self + " --memory " + faces).c_str(), "r");
  double megabytes = 0, seconds = 0;
  const bool is_read = run != nullptr && std::fscanf(run, "%lf %lf", &megabytes, &seconds) == 2;
  if (run != nullptr) pclose(run);
  if (!is_read) std::abort();
  goals.at_most(std::string(faces) + " faces, ARAP: peak, megabytes", asked, megabytes);
}

/// share: of the faces of made meshes. A small one says nothing but that all of this runs.
void show_all(Goals& goals, const std::string& self, double share = 1) {
  show_memory(goals, self, share == 1 ? "1e6" : "1e3", 1200);
  if (share == 1 && !test_data().empty()) {
    compare_with_cgal(goals, "Isis", "Isis_dABF.obj");
    compare_with_cgal(goals, "Balls", "Balls.obj");
  }
  compare_engines(goals, share * 1e5, "100k faces");
  compare_engines(goals, share * 1e6, "1M faces");
  show_second_jobs(goals, surface(share * 1e5));
  show_iteration(goals, surface(share * 1e5), "100k faces");
  show_iteration(goals, surface(share * 3.2e5), "320k faces");
  if (share < 1)
    show_convergence(goals, surface(500), "Sheet");
  else if (!test_data().empty())
    show_convergence(goals, read_obj(test_data() / "paper" / "Gargoyle_ABF.obj"), "Gargoyle");
  show_threads(goals, surface(share * 3.2e5));
  show_growth(goals, share);
}

int run(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--memory") == 0)
    return show_memory(std::strtod(argv[2], nullptr));
  Goals goals;
  if (argc == 2 && std::strcmp(argv[1], "--large") == 0)
    show_memory(goals, argv[0], "4e6", 5000);
  else
    show_all(goals, argv[0], argc == 3 && std::strcmp(argv[2], "--tiny") == 0 ? 0.01 : 1);
  if (argc >= 2 && argv[1][0] != '-') std::ofstream(argv[1]) << goals.json();
  return 0;
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  try {
    return unwrapd::bench::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "unwrapd_bench: %s\n", e.what());
    return 1;
  }
}
