// Our engine beside Eigen's SimplicialLLT and CHOLMOD, on the matrix of ARAP's global step and on
// those of two unknowns a vertex (LSCM, SLIM). One thread, processor time: another program's load
// changes it less than it changes wall time. Needs only the core.
//   unwrapd_engine [FACES [OUT.json]]   nothing above that size (2e6); the same figures as JSON
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "core/measure/rest_triangle.hpp"
#include "core/solve/maps/conformal_system.hpp"
#include "tests/bench/goals.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/rivals.hpp"
#include "tests/core/linear/systems.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::bench {
namespace {

constexpr double kShift = 1e-6;  // added to the diagonal of LSCM's matrix: definite without pins

class Table {
 public:
  Table() : bandwidth_(read_bandwidth(processor_seconds)) {
    json_ << "{\"processor\": \"" << processor() << "\", \"commit\": \"" << commit()
          << "\", \"read_gb_per_second\": " << bandwidth_ << ", \"rows\": [";
    std::printf("%s, commit %s; one thread reads %.1f GB/s\n", processor().c_str(),
                commit().c_str(), bandwidth_);
    std::puts(
        "milliseconds                   engine   analysis    factor  refactor    solve  "
        "with 10   MB of L  solve/reading L twice");
  }

  void start(std::string matrix, std::size_t faces, const Times& ours) {
    matrix_ = std::move(matrix), faces_ = faces, ours_ = ours;
    add("ours", ours);
  }

  void add(const char* engine, const Times& t) {
    std::printf("%-20s %8zu %-8s %9.1f %9.1f %9.1f %8.2f %8.0f %9.1f %8.2f", matrix_.c_str(),
                faces_, engine, t.analysis, t.factor, t.refactor, t.solve, t.ten_iterations(),
                t.megabytes, t.solve / (2 * t.megabytes / bandwidth_));
    std::printf("  %5.2fx\n", t.ten_iterations() / ours_.ten_iterations());
    std::fflush(stdout);
    json_ << (is_first_ ? "\n" : ",\n") << "{\"matrix\": \"" << matrix_
          << "\", \"faces\": " << faces_ << ", \"engine\": \"" << engine
          << "\", \"analysis_ms\": " << t.analysis << ", \"factor_ms\": " << t.factor
          << ", \"refactor_ms\": " << t.refactor << ", \"solve_ms\": " << t.solve
          << ", \"megabytes\": " << t.megabytes << "}";
    is_first_ = false;
  }

  [[nodiscard]] std::string json() const { return json_.str() + "\n]}\n"; }

 private:
  double bandwidth_;
  std::ostringstream json_;
  std::string matrix_;
  std::size_t faces_ = 0;
  Times ours_;
  bool is_first_ = true;
};

linear::ComplexMatrix lscm_matrix(const solve::Disk& disk) {
  linear::ComplexMatrix lower = solve::maps::conformal_matrix(disk);
  for (Index v = 0; v < disk.vertex_count(); ++v) lower.coeffRef(v, v) += kShift;
  lower.makeCompressed();
  return lower;
}

void compare(const std::string& name, const TriMesh& mesh, Table& table) {
  const shapes::OwnedDisk owned = shapes::disk_of(mesh);
  const std::size_t faces = mesh.faces.size();
  const linear::SparseMatrix arap = linear::arap_matrix(owned.disk);
  table.start(name + ", ARAP", faces, time_ours(arap, Unknowns::single));
  table.add("Eigen", time_eigen(arap, Unknowns::single));
  if (const auto times = time_cholmod(arap, Unknowns::single)) table.add("CHOLMOD", *times);
  const linear::ComplexMatrix lscm = lscm_matrix(owned.disk);
  const linear::SparseMatrix pairs = linear::as_pairs(lscm);
  table.start(name + ", pairs", faces, time_ours(pairs, Unknowns::pairs));
  table.add("Eigen", time_eigen(pairs, Unknowns::pairs));
  table.add("Eigen C", time_eigen(lscm));
  if (const auto times = time_cholmod(pairs, Unknowns::pairs)) table.add("CHOLMOD", *times);
}

void compare_all(double most_faces, Table& table) {
  for (double faces : {20e3, 100e3, 320e3, 1e6})
    if (faces <= most_faces) compare("sheet", surface(faces), table);
  if (test_data().empty()) return;
  TriMesh mesh = read_obj(test_data() / "paper" / "Gargoyle_ABF.obj");
  for (; static_cast<double>(mesh.faces.size()) <= std::min(most_faces, 400e3);
       mesh = shapes::subdivided(mesh))
    compare("Gargoyle", mesh, table);
}

}  // namespace
}  // namespace unwrapd::bench

int main(int argc, char** argv) {
  unwrapd::bench::Table table;
  unwrapd::bench::compare_all(argc > 1 ? std::strtod(argv[1], nullptr) : 2e6, table);
  if (argc > 2) std::ofstream(argv[2]) << table.json();
  return 0;
}
