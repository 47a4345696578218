// Our engine beside Eigen's SimplicialLLT on the matrix of the global step, one thread, processor
// time: another program's load changes it less than it changes wall time. Needs only the core.
//   unwrapd_engine           20k, 100k, 320k and 1M faces of a sheet; Gargoyle, as it is and finer
//   unwrapd_engine FACES     nothing above that size
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "core/linear/engine.hpp"
#include "core/measure/rest_triangle.hpp"
#include "tests/bench/measure.hpp"
#include "tests/core/obj_reader.hpp"

namespace unwrapd::bench {
namespace {

constexpr int kSolves = 9;

/// Milliseconds of the processor that a call takes.
template <typename Call>
double milliseconds(Call call) {
  const std::clock_t start = std::clock();
  call();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

template <typename Call>
double median_milliseconds(Call call) {
  std::array<double, kSolves> took{};
  for (double& t : took) t = milliseconds(call);
  std::sort(took.begin(), took.end());
  return took[kSolves / 2];
}

struct Times {
  double analysis, factor, solve, megabytes;

  [[nodiscard]] double ten_iterations() const { return analysis + factor + 10 * solve; }
};

SparseMatrix matrix_of(const TriMesh& mesh) {
  std::vector<double> weight;
  for (const RestTriangle& rest : flatten(mesh))
    weight.insert(weight.end(), rest.cot.begin(), rest.cot.end());
  SparseMatrix lower = lower_laplacian(mesh.faces, mesh.vertex_count(), weight);
  lower.coeffRef(0, 0) *= 2;
  return lower;
}

Times time_ours(const SparseMatrix& lower) {
  std::shared_ptr<const Analysis> analysis;
  std::unique_ptr<RealSystem> system;
  std::vector<Vec2> b(static_cast<std::size_t>(lower.cols()), Vec2(1, -1));
  Times times{};
  times.analysis = milliseconds([&] { analysis = analyse(lower); });
  times.factor = milliseconds([&] { system = try_factor(analysis, lower); });
  if (!system) std::abort();
  times.solve = median_milliseconds([&] { system->solve(b); });
  times.megabytes = 8e-6 * static_cast<double>(analysis->panel_begin.back()) +
                    4e-6 * static_cast<double>(analysis->nodes.row.size());
  return times;
}

Times time_eigen(const SparseMatrix& lower) {
  Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower> llt;
  Eigen::MatrixX2d b = Eigen::MatrixX2d::Ones(lower.cols(), 2);
  Times times{};
  times.analysis = milliseconds([&] { llt.analyzePattern(lower); });
  times.factor = milliseconds([&] { llt.factorize(lower); });
  times.solve = median_milliseconds([&] { b = llt.solve(b).eval(); });
  times.megabytes = 12e-6 * static_cast<double>(SparseMatrix(llt.matrixL()).nonZeros());
  return times;
}

void compare(const char* name, const TriMesh& mesh) {
  const SparseMatrix lower = matrix_of(mesh);
  const Times a = time_ours(lower), b = time_eigen(lower);
  const auto row = [&](const char* engine, const Times& t) {
    std::printf("%-9s %8zu %-7s %9.1f %9.1f %8.2f %8.0f %8.1f\n", name, mesh.faces.size(), engine,
                t.analysis, t.factor, t.solve, t.ten_iterations(), t.megabytes);
  };
  row("ours", a);
  row("Eigen", b);
  std::printf("%-26s %9.2f %9.2f %8.2f %8.2f %8.2f\n", "  ratio", b.analysis / a.analysis,
              b.factor / a.factor, b.solve / a.solve, b.ten_iterations() / a.ten_iterations(),
              b.megabytes / a.megabytes);
}

void show_table(double most_faces) {
  std::puts("milliseconds      faces engine   analysis    factor    solve  with 10   MB of L");
  for (double faces : {20e3, 100e3, 320e3, 1e6})
    if (faces <= most_faces) compare("sheet", sheet(faces));
  if (test_data().empty()) return;
  TriMesh mesh = read_obj(test_data() / "paper" / "Gargoyle_ABF.obj");
  for (; static_cast<double>(mesh.faces.size()) <= std::min(most_faces, 400e3);
       mesh = shapes::subdivided(mesh))
    compare("Gargoyle", mesh);
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  unwrapd::bench::show_table(argc > 1 ? std::strtod(argv[1], nullptr) : 2e6);
  return 0;
}
